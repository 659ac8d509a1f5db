#include "rigs/emulated/hidden/conditions.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "hil/base/portable_math.h"

namespace forcegate::hidden {
namespace {

double log_uniform(Rng& rng, double low, double high) {
  return low * portable::pow(high / low, rng.uniform());
}

bool chance(Rng& rng, double probability) { return rng.uniform() < probability; }

/// Other laboratories: other instruments, sessions, loggers and protocols. Drawn from a stream of its own.
void widen(std::uint64_t seed, const ConditionNeeds& needs, Conditions& c) {
  Rng rng(seed, "conditions/other");
  if (chance(rng, 0.4)) {
    constexpr double kSteps_N[] = {0.001, 0.005, 0.01, 0.05};
    c.reference_step_N = kSteps_N[rng.below(std::size(kSteps_N))];
    c.reference_noise_N = std::max(0.0015, c.reference_step_N * log_uniform(rng, 0.1, 1.0));
  }
  if (chance(rng, 0.3)) {
    constexpr double kSlow_Hz[] = {125.0, 160.0, 500.0}, kFast_Hz[] = {125.0, 300.0, 2000.0};
    c.slow_rate_Hz = kSlow_Hz[rng.below(std::size(kSlow_Hz))];
    c.fast_rate_Hz = kFast_Hz[rng.below(std::size(kFast_Hz))];
    if (needs.fast_reference) c.fast_rate_Hz = std::max(c.fast_rate_Hz, 300.0);
  }
  if (chance(rng, 0.35)) {
    constexpr double kRanges_V[] = {2.5, 3.3, 5.0};
    const double range_V = kRanges_V[rng.below(std::size(kRanges_V))], scale = range_V / c.voltage_max_V;
    c.voltage_max_V = range_V;
    c.gain_N_per_V /= scale;
    c.voltage_noise_V *= scale;
    c.wander_V *= scale;
  }
  if (chance(rng, 0.35)) c.session_share = rng.uniform(0.3, 0.9);
  if (chance(rng, 0.2)) c.gaps_per_hour = log_uniform(rng, 2.0, 30.0);
  const double length = rng.uniform();
  c.short_protocol = length < 0.2;
  c.long_protocol = length > 0.9;
  c.wide_loads = chance(rng, 0.4);
}

}  // namespace

Conditions draw_conditions(std::uint64_t seed, const ConditionNeeds& needs) {
  Rng rng(seed, "conditions");
  Conditions c;
  constexpr double kRates_Hz[] = {200.0, 250.0, 400.0, 500.0, 1000.0};
  c.fast_rate_Hz = kRates_Hz[rng.below(std::size(kRates_Hz))];
  c.slow_rate_Hz = chance(rng, 0.8) ? 200.0 : std::min(250.0, c.fast_rate_Hz);
  c.jitter_share = chance(rng, 0.5) ? log_uniform(rng, 0.002, 0.08) : 0.0;
  c.clock_ppm = rng.normal(0.0, 15.0);
  c.stamps_true = chance(rng, 0.4);
  c.log_theta = chance(rng, 0.75) || needs.theta;
  c.log_command = chance(rng, 0.3) || needs.command;
  c.log_temperature = chance(rng, 0.6);
  c.log_capacitance = chance(rng, 0.15);
  Rng air(seed, "conditions/air");
  c.log_humidity = chance(air, needs.climate ? 0.7 : 0.25);

  const double law = rng.uniform();
  c.decay = law < 0.46   ? DecayLaw::ratio
            : law < 0.64 ? DecayLaw::root_f
            : law < 0.80 ? DecayLaw::exponential_A
            : law < 0.94 ? DecayLaw::state_driven
                         : DecayLaw::absolute;
  c.gain_N_per_V = 0.5 * std::clamp(1.0 + 0.09 * rng.normal(), 0.75, 1.3);
  c.offset_N = -0.1 * std::clamp(1.0 + 0.22 * rng.normal(), 0.3, 1.8);
  c.b_scale = std::clamp(1.0 + 0.25 * rng.normal(), 0.4, 1.8);
  c.q_scale = std::clamp(1.0 + 0.14 * rng.normal(), 0.6, 1.5);
  c.sd_b = log_uniform(rng, 0.02, 0.25);
  c.sd_q = log_uniform(rng, 0.015, 0.14);
  c.sd_gain = log_uniform(rng, 0.0005, 0.03);
  c.sd_offset_pct = log_uniform(rng, 0.02, 0.8);

  constexpr int kBits[] = {12, 12, 14, 16};
  c.adc_bits = kBits[rng.below(std::size(kBits))];
  c.voltage_noise_V = log_uniform(rng, 0.001, 0.012);
  c.wander_V = log_uniform(rng, 0.0005, 0.012);
  c.wander_tau_s = log_uniform(rng, 60.0, 3000.0);
  c.reference_noise_N = 0.025 * log_uniform(rng, 0.1, 0.7);
  const double lag = rng.uniform();
  c.reference_lag_s = chance(rng, 0.5) ? 0.005 * lag * lag : 0.0;
  if (needs.fast_reference) c.reference_lag_s = std::min(c.reference_lag_s, 0.0004);

  c.spring_N_per_mm = 0.25 * (1.0 + 0.01 * rng.normal());
  c.motor_tau_s = rng.uniform(0.010, 0.030);
  c.wheel_radius_mm = rng.uniform(22.0, 40.0);
  c.force_max_N = std::min(4.6, 9.3 * c.gain_N_per_V + c.offset_N);
  c.vary_drive = needs.drive || chance(rng, 0.15);
  c.remount = needs.remounting || chance(rng, 0.2);
  c.climate_swing_C = needs.climate ? rng.uniform(2.5, 6.0) : rng.uniform(0.3, 3.0);
  c.climate_swing_pct = needs.climate ? rng.uniform(8.0, 20.0) : rng.uniform(2.0, 8.0);
  c.documented = rng.uniform(0.55, 1.0);
  c.roles_given = chance(rng, 0.82);
  widen(seed, needs, c);
  return c;
}

}  // namespace forcegate::hidden
