#include "rigs/emulated/hidden/climate.h"

#include "hil/base/portable_math.h"

namespace forcegate::hidden {
namespace {

constexpr double kTwoPi = 6.28318530717958647692;

}  // namespace

Climate::Climate(Rng& rng, double swing_C, double swing_humidity_pct, double span_s) {
  mean_C_ = rng.uniform(20.0, 25.0);
  mean_pct_ = rng.uniform(30.0, 60.0);
  temperature_[0] = {swing_C * rng.uniform(0.5, 0.9), span_s * rng.uniform(0.8, 2.2),
                     rng.uniform(0.0, kTwoPi)};
  temperature_[1] = {swing_C * rng.uniform(0.1, 0.4), span_s * rng.uniform(0.2, 0.5),
                     rng.uniform(0.0, kTwoPi)};
  temperature_[2] = {rng.uniform(0.02, 0.25), rng.uniform(500.0, 1500.0), rng.uniform(0.0, kTwoPi)};
  heating_C_ = rng.uniform() < 0.4 ? swing_C * rng.uniform(0.3, 0.8) : 0.0;
  heating_at_s_ = span_s * rng.uniform(0.1, 0.8);
  heating_tau_s_ = rng.uniform(600.0, 2500.0);
  humidity_[0] = {swing_humidity_pct * rng.uniform(0.6, 1.0), span_s * rng.uniform(1.0, 2.5),
                  rng.uniform(0.0, kTwoPi)};
  humidity_[1] = {swing_humidity_pct * rng.uniform(0.1, 0.4), span_s * rng.uniform(0.3, 0.7),
                  rng.uniform(0.0, kTwoPi)};
  humidity_[2] = {rng.uniform(0.1, 0.6), rng.uniform(700.0, 2000.0), rng.uniform(0.0, kTwoPi)};
}

double Climate::sum(const std::array<Wave, 3>& waves, double t_s) const {
  double total = 0.0;
  for (const Wave& wave : waves)
    total += wave.amplitude * portable::sin(kTwoPi * t_s / wave.period_s + wave.phase_rad);
  return total;
}

double Climate::temperature_C(double campaign_s) const {
  double value = mean_C_ + sum(temperature_, campaign_s);
  if (heating_C_ != 0.0 && campaign_s > heating_at_s_)
    value += heating_C_ * (1.0 - portable::exp(-(campaign_s - heating_at_s_) / heating_tau_s_));
  return value;
}

double Climate::humidity_pct(double campaign_s) const { return mean_pct_ + sum(humidity_, campaign_s); }

}  // namespace forcegate::hidden
