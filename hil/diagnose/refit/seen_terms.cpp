#include "hil/diagnose/refit/seen_terms.h"

#include <fmt/format.h>

#include <algorithm>

#include "hil/base/plain_number.h"

namespace forcegate::diagnose {

namespace {

double longest_record_s(const CampaignInput& input) {
  double out = 0.0;
  for (const RecordInput& r : input.records) out = std::max(out, r.duration_s);
  return out;
}

}  // namespace

bool is_seen(const EffectForm& form, std::size_t strength, const CampaignInput& input) {
  constexpr double kOfRecord = 2.0;
  return form.memory_s.empty() || form.memory_s[strength] <= kOfRecord * longest_record_s(input);
}

std::vector<int> seen_columns(const Workspace& w, int variant, std::vector<std::string>& notes) {
  const Candidate& c = candidate_of(w.output, variant);
  std::vector<int> out = columns_of(w.output, variant);
  double least_s = 0.0;
  std::erase_if(out, [&](int column) {
    const auto strength = static_cast<std::size_t>(column - c.first);
    if (is_seen(*c.form, strength, w.input)) return false;
    const double memory_s = c.form->memory_s[strength];
    least_s = least_s > 0.0 ? std::min(least_s, memory_s) : memory_s;
    return true;
  });
  if (least_s == 0.0) return out;
  if (out.empty()) return columns_of(w.output, variant);
  const std::string note = fmt::format("{}: terms of {} s and longer are left out, since the longest record has {} s: a longer one tells them", c.kind->name, plain_number(least_s),
                                       plain_number(longest_record_s(w.input)));
  if (std::ranges::find(notes, note) == notes.end()) notes.push_back(note);
  return out;
}

}  // namespace forcegate::diagnose
