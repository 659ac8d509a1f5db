#include "hil/report/finding_side.h"

#include <algorithm>
#include <vector>

#include "hil/base/text.h"

namespace forcegate {

std::string unclaimed_share(const Diagnosis& d) {
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
