#include "hil/app/export/recorded_output.h"

#include <algorithm>
#include <cmath>

namespace forcegate {

std::vector<double> recorded_output(const Campaign& campaign, const RecordInput& rows, const std::vector<double>& t_s, std::vector<double>* read_s) {
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
    const double taken = step_s <= kAsFast * instant_s ? std::round(share) : share;
    out.push_back(taken == 1.0 ? U[k + 1] : U[k] + taken * (U[k + 1] - U[k]));
    if (read_s != nullptr) read_s->push_back(at_s[k] + taken * step_s);
  }
  return out;
}

}  // namespace forcegate
