#include "hil/diagnose/answer/verdict.h"

#include <algorithm>

namespace forcegate::diagnose {

DiagnosisVerdict verdict_of(const std::vector<Finding>& findings, const OpenPoints& open) {
  if (std::ranges::any_of(findings, &Finding::claimed)) return DiagnosisVerdict::known;
  return open.any() ? DiagnosisVerdict::unknown : DiagnosisVerdict::none;
}

bool name_is_open(const Diagnosis& d, const std::vector<Finding>& not_borne_out) {
  constexpr double kTogether = 0.8;
  if (!std::ranges::all_of(not_borne_out, &Finding::between_records)) return true;
  if (std::ranges::any_of(d.findings, [](const Finding& f) { return f.name_is_open && f.probability >= kNoClaim; })) return true;
  return std::ranges::any_of(d.not_separable, [&](const std::vector<std::string>& set) {
    double together = 0.0;
    for (const Finding& f : d.findings)
      if (std::ranges::find(set, f.effect) != set.end()) together += f.probability;
    return together >= kTogether;
  });
}

}  // namespace forcegate::diagnose
