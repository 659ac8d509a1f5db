#include "hil/diagnose/raw/matched_lowpass.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace forcegate::diagnose {

void match_reference_lowpass(Record& record, std::span<const std::uint8_t> bad, double corner_Hz) {
  constexpr double kSettles = 5.0, kShort = 0.1, kSteps = 3.0;  // times tau; samples
  Channel* output = record.trace.find("U");
  if (output == nullptr || output->value.size() < 2) return;
  const double tau_s = 1.0 / (2.0 * std::numbers::pi * corner_Hz);
  const std::vector<double>& t_s = record.trace.time_bases[output->time_base].t_s;
  const double usual_step_s = (t_s.back() - t_s.front()) / static_cast<double>(t_s.size() - 1);
  const bool marked = bad.size() == output->value.size();
  double held = kMissing, last_s = -std::numeric_limits<double>::infinity(), settled_s = last_s;
  for (std::size_t i = 0; i < output->value.size(); ++i) {
    double& u = output->value[i];
    if (!std::isfinite(u) || (marked && bad[i] != 0)) continue;
    const double step_s = t_s[i] - last_s;
    if (step_s > std::fmax(kShort * tau_s, kSteps * usual_step_s)) settled_s = t_s[i] + kSettles * tau_s;
    held = std::isfinite(step_s) ? held + (u - held) * -std::expm1(-step_s / tau_s) : u;
    last_s = t_s[i];
    u = t_s[i] < settled_s ? kMissing : held;
  }
}

}  // namespace forcegate::diagnose
