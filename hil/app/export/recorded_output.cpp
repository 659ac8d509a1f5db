#include "hil/app/export/recorded_output.h"

#include <algorithm>
#include <cmath>

namespace forcegate {

std::vector<double> recorded_output(const Campaign& campaign, const RecordInput& rows, const std::vector<double>& t_s) {
  const auto record = std::ranges::find(campaign.records, rows.name, &Record::name);
  const Channel* output = record == campaign.records.end() ? nullptr : record->trace.find("U");
  if (output == nullptr) return {};
  const std::vector<double>& clock_s = record->trace.time_bases[output->time_base].t_s;
  std::vector<double> at_s, U;
  for (std::size_t i = 0; i < std::min(clock_s.size(), output->value.size()); ++i)
    if (std::isfinite(output->value[i])) {
      at_s.push_back(clock_s[i] - rows.clock_start_s);
      U.push_back(output->value[i]);
    }
  if (U.size() < 2) return {};
  constexpr double kAsFast = 1.5;
  const double instant_s = t_s.size() > 1 ? (t_s.back() - t_s.front()) / static_cast<double>(t_s.size() - 1) : 0.0;
  std::vector<double> out;
  out.reserve(t_s.size());
  std::size_t k = 0;
  for (const double t : t_s) {
    while (k + 2 < at_s.size() && at_s[k + 1] <= t) ++k;
    const double step_s = at_s[k + 1] - at_s[k];
    const double share = step_s > 0.0 ? std::clamp((t - at_s[k]) / step_s, 0.0, 1.0) : 0.0;
    if (step_s <= kAsFast * instant_s) out.push_back(share < 0.5 ? U[k] : U[k + 1]);
    else out.push_back(U[k] + share * (U[k + 1] - U[k]));
  }
  return out;
}

}  // namespace forcegate
