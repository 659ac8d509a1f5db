#include "hil/diagnose/raw/record_scales.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "hil/base/quantile.h"
#include "hil/diagnose/raw/sample_noise.h"
#include "hil/model/came_in.h"

namespace forcegate::diagnose {

namespace {

// What the output typically does between two samples beside the force, as a standard deviation; 0 where the force does most of it. Of an
// output that rings it is no noise, and its peaks stand above every straight line through their neighbours.
double restlessness(const std::vector<double>& F, const std::vector<double>& U, double gain_V_per_N) {
  constexpr std::size_t kEnough = 20000;
  constexpr double kOfForce = 0.5;
  std::vector<double> moved, by_force;
  for (std::size_t i = 1; i < U.size(); i += 1 + U.size() / kEnough) {
    const double force = gain_V_per_N * (F[i] - F[i - 1]), beside = U[i] - U[i - 1] - force;
    if (!std::isfinite(beside)) continue;
    moved.push_back(std::abs(beside));
    by_force.push_back(std::abs(force));
  }
  if (moved.empty()) return 0.0;
  const double typical = quantile(std::move(moved), 0.5);
  return typical > kOfForce * quantile(std::move(by_force), 0.5) ? 1.4826 * typical : 0.0;
}

// A few levels of a staircase show no step: it is then that of all records. Levels that somebody set have none.
double step_of_force(const ForceAndOutput& samples, const HealthScales& campaign) {
  const double own_N = value_step(samples.F_N()), step_N = own_N == 0.0 ? campaign.step_N : own_N;
  return are_set_levels(samples.F_N(), step_N, samples.U_V(), campaign.gain_V_per_N) ? 0.0 : step_N;
}

// Where no record shows one it is that which the converter is said to have.
double step_of_output(const ForceAndOutput& samples, const HealthScales& campaign, const BenchFacts& bench) {
  const double own_V = value_step(samples.U_V()), step_V = own_V == 0.0 ? campaign.step_V : own_V;
  if (step_V != 0.0 || !shows_few_values(samples.U_V())) return step_V;
  return declared_step_V(bench, campaign.U_range_V);
}

}  // namespace

double declared_step_V(const BenchFacts& bench, double U_range_V) {
  if (bench.adc_bits <= 0) return 0.0;
  const double range_V = std::isfinite(bench.voltage_max_V) ? bench.voltage_max_V - lowest_code_V(bench) : U_range_V;
  return range_V / std::exp2(bench.adc_bits);
}

double declared_step_V(const CampaignInput& campaign) { return campaign.in_counts ? 0.0 : declared_step_V(campaign.bench, campaign.U_range_V); }

double declared_step_N(const BenchFacts& bench) { return std::isfinite(bench.reference_resolution_N) ? bench.reference_resolution_N : 0.0; }

double quiet_step_V(const ForceAndOutput& samples, double noise_V, double lsb_V, const HealthScales& campaign) {
  constexpr double kOfNoise = 8.0, kNoiseOfStep = 0.3, kOfRange = 0.012, kOfRestless = 6.0;
  return std::max(kOfNoise * std::max(noise_V, kNoiseOfStep * lsb_V) + kOfRange * campaign.U_range_V,
                  kOfRestless * restlessness(samples.F_N(), samples.U_V(), campaign.gain_V_per_N));
}

RecordScales record_scales(const ForceAndOutput& samples, const HealthScales& campaign, const BenchFacts& bench) {
  RecordScales out{.gain_V_per_N = campaign.gain_V_per_N, .range_N = campaign.range_N, .U_range_V = campaign.U_range_V};
  out.low_V = lowest_code_V(bench);
  out.high_V = bench.voltage_max_V;
  out.noise_F_N = std::min(white_noise(samples.F_N()), restless_noise(samples.t_s(), samples.F_N()));
  out.noise_U_V = white_noise(samples.U_V());
  out.lsb_F_N = step_of_force(samples, campaign);
  out.lsb_U_V = step_of_output(samples, campaign, bench);
  out.quiet_V = quiet_step_V(samples, out.noise_U_V, out.lsb_U_V, campaign);
  out.near_V = std::max({1.5 * out.lsb_U_V, 4.0 * out.noise_U_V, 0.005 * out.U_range_V});
  return out;
}

}  // namespace forcegate::diagnose
