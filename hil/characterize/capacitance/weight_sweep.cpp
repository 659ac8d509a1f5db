#include "hil/characterize/capacitance/weight_sweep.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace forcegate::characterize {
namespace {

constexpr double kDeparture = 1.2;  // BodeFit::divergence_Hz: eq. (9) over what is measured

// The same definition on the true admittance.
double true_divergence_Hz(const WeightBench& bench, std::size_t sensor, double low_Hz, double high_Hz) {
  const auto at_rest = bench.true_admittance_S(sensor, 1.0);
  if (!at_rest) return std::nan("");
  const auto ratio = [&](double f_Hz) {
    const auto y = *bench.true_admittance_S(sensor, f_Hz);
    return at_rest->imag() / at_rest->real() * f_Hz * y.real() / y.imag();
  };
  if (ratio(high_Hz) < kDeparture) return std::nan("");
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(low_Hz * high_Hz);
    (ratio(middle) < kDeparture ? low_Hz : high_Hz) = middle;
  }
  return low_Hz;
}

}  // namespace

std::vector<double> sweep_frequencies_Hz(const WeightPlan& plan, double rate_Hz) {
  const double bin_Hz = rate_Hz / static_cast<double>(plan.sweep_samples);
  std::vector<double> out;
  for (std::size_t i = 0; i < plan.sweep_points; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(plan.sweep_points - 1);
    const double f_Hz =
        std::max(1.0, std::round(plan.sweep_low_Hz * std::pow(plan.sweep_high_Hz / plan.sweep_low_Hz, share) /
                                 bin_Hz)) *
        bin_Hz;
    if (out.empty() || f_Hz > out.back()) out.push_back(f_Hz);
  }
  return out;
}

Result<SweepResult> play_sweep(WeightBench& bench, std::size_t sensor, double force_N,
                               const WeightPlan& plan) {
  const WeightBenchInfo info = bench.info();
  const impedance::Circuit circuit{info.feedback_ohm, info.feedback_u_rel, info.gain_bandwidth_Hz,
                                   info.gain_bandwidth_u_rel};
  SweepResult out;
  out.force_N = force_N;
  std::vector<std::int16_t> codes(plan.sweep_samples);
  for (const double f_Hz : sweep_frequencies_Hz(plan, info.rate_Hz)) {
    FORCEGATE_CHECK_OK(bench.capture(sensor, {WeightBenchSource::Kind::sine, plan.sweep_V, f_Hz}, codes));
    const auto phasor = impedance::lock_in(codes, f_Hz, info.rate_Hz, info.volts_per_code(),
                                           std::min(info.rail_V, info.range_V) - info.volts_per_code());
    out.readings.push_back(impedance::rc_reading(phasor, plan.sweep_V, f_Hz, circuit));
  }
  const auto fit = impedance::fit_bode(out.readings, info.feedback_u_rel);
  out.fitted = fit.has_value();
  if (fit) out.fit = *fit;
  out.true_conductance_S = out.true_capacitance_F = out.true_divergence_Hz = std::nan("");
  if (const auto y = bench.true_admittance_S(sensor, 1.0)) {
    out.true_conductance_S = y->real();
    out.true_capacitance_F = y->imag() / (2.0 * std::numbers::pi);
    out.true_divergence_Hz = true_divergence_Hz(bench, sensor, plan.sweep_low_Hz, plan.sweep_high_Hz);
  }
  if (!out.fitted || std::isnan(out.fit.divergence_Hz)) return out;
  for (const auto& r : out.readings) {
    const bool flagged = out.fit.departs(r);
    if (r.f_Hz >= 1000.0 && r.f_Hz <= 0.4 * out.fit.divergence_Hz)
      ++out.inside, out.flagged_inside += flagged ? 1 : 0;
    if (r.f_Hz >= 1.5 * out.fit.divergence_Hz) ++out.outside, out.flagged_outside += flagged ? 1 : 0;
  }
  return out;
}

}  // namespace forcegate::characterize
