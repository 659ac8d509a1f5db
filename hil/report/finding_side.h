#pragma once
// Where a finding stands, for people.

#include <algorithm>
#include <string>
#include <vector>

#include "hil/base/text.h"
#include "hil/diagnose/diagnosis.h"

namespace forcegate {

/// Its side, or that nothing in the records could tell it.
inline std::string shown_side(const Finding& f) { return f.side_witnessed ? f.side : "side unknown"; }

/// ", with creep, which is not claimed": what else than claims the error after holds, as the waterfall draws it hollow. Empty: nothing.
inline std::string unclaimed_share(const Diagnosis& d) {
  std::vector<std::string> names;
  for (const ModelStep& step : d.steps)
    if (!step.effect.empty() && std::ranges::none_of(d.findings, [&](const Finding& f) { return f.effect == step.effect && f.claimed(); }))
      names.push_back(step.effect);
  if (names.empty()) return {};
  const auto rivals = std::ranges::find_if(d.not_separable, [&](const auto& group) { return std::ranges::find(group, names.front()) != group.end(); });
  return ", with " + (names.size() == 1 && rivals != d.not_separable.end() ? join(*rivals, " or ") : join(names, ", ")) +
         (names.size() > 1 ? ", which are not claimed" : ", which is not claimed");
}

}  // namespace forcegate
