#include "hil/diagnose/raw/reference_noise_claim.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "hil/base/plain_number.h"
#include "hil/base/quantile.h"

namespace forcegate::diagnose {

namespace {

HealthClaim claim_of(double probability, double found, const std::string& beside) {
  return {"reference_noise", probability, "the reference scatters by " + plain_number(found) + " N " + beside, "noise_N", "N", found, 0.05 * found};
}

// Nobody said what it may scatter by: a cell that is far noisier than the sensor that it is there for is worth a look, and no claim.
std::optional<HealthClaim> undeclared(double found, const std::vector<RecordHealth>& health, const HealthScales& scales) {
  constexpr double kListed = 0.4, kLeast = 0.01, kTimes = 4.0;  // kLeast: of the range
  std::vector<double> output;
  for (const RecordHealth& h : health) output.push_back(h.noise_U_V);
  if (output.empty() || scales.gain_V_per_N == 0.0 || !(found > kLeast * scales.range_N)) return std::nullopt;
  const double sensor_N = quantile(output, 0.5) / std::abs(scales.gain_V_per_N);
  if (!(found > kTimes * sensor_N)) return std::nullopt;
  return claim_of(kListed, found, "and the output by " + plain_number(sensor_N) + " N; not claimed: nothing is declared that it could be held against (reference_noise_N)");
}

// Whatever was declared: the reference is restless in some windows and quiet in the rest, and the output stands still in both.
std::optional<HealthClaim> in_bursts(const std::vector<RecordHealth>& health, const HealthScales& scales, double allowed) {
  constexpr double kLeast = 0.0025, kAbove = 2.0, kProbability = 0.93;  // kLeast: of the range
  double square = 0.0, quiet = 0.0, share = 0.0, records = 0.0, can_tell = 0.0;
  for (const RecordHealth& h : health) {
    const ReferenceScatter& f = h.scatter_F;
    can_tell += std::isfinite(f.burst_N) ? 1.0 : 0.0;
    if (!(f.burst_N > kLeast * scales.range_N && f.burst_N > kAbove * allowed)) continue;
    square += f.burst_N * f.burst_N;
    quiet += f.between_bursts_N;
    share += f.burst_share;
    records += 1.0;
  }
  if (records < std::min(2.0, static_cast<double>(health.size())) || 2.0 * records < can_tell) return std::nullopt;
  const double found = std::sqrt(square / records);
  return claim_of(kProbability, found, "in bursts, " + plain_number(std::round(100.0 * share / records)) + " % of the time, and by " + plain_number(quiet / records) + " N between them, while the output stands still in both");
}

// White noise of a sample that neither the movement of the force nor the output shares.
double own_noise_N(const RecordHealth& h) { return std::min(std::max(h.noise_F_N, h.scatter_F.quartile_N), h.scatter_F.alone_N); }

// Where the force moves in every window nothing is left of the scatter beside the output, and nothing is known of it.
bool moves_throughout(const RecordHealth& h) { return own_noise_N(h) == 0.0 && h.noise_F_N > h.lsb_F_N; }

double middle_of_output_V(std::span<const RecordHealth* const> records) {
  std::vector<double> noise;
  for (const RecordHealth* h : records) noise.push_back(h->noise_U_V);
  return quantile(std::move(noise), 0.5);
}

// Whatever was declared: quiet in some records and restless in the others, of one size in each, while the output is as noisy in both. A force that moves fast is restless
// too: the output stands still meanwhile.
std::optional<HealthClaim> in_some_records(const std::vector<RecordHealth>& health, const HealthScales& scales) {
  constexpr double kLeast = 0.0025, kTimes = 3.0, kAlike = 3.0, kOutputAlike = 1.3, kOwn = 0.5, kProbability = 0.93;  // kLeast: of the range
  constexpr std::size_t kFewest = 2;
  double step_N = 0.0;
  for (const RecordHealth& h : health) step_N = std::max(step_N, h.lsb_F_N);
  // as it is: what the output brings into a quiet record is taken off by a difference that may leave nothing
  const auto noise_N = [&](const RecordHealth* h) { return std::max(h->noise_F_N, 0.5 * step_N); };
  std::vector<const RecordHealth*> order;
  for (const RecordHealth& h : health)
    if (std::isfinite(own_noise_N(h))) order.push_back(&h);
  std::ranges::stable_sort(order, {}, noise_N);
  std::size_t quiet = 0;
  double widest = kTimes;
  for (std::size_t k = kFewest; k + kFewest <= order.size(); ++k)
    if (const double times = noise_N(order[k]) / noise_N(order[k - 1]); times > widest) widest = times, quiet = k;
  if (quiet == 0) return std::nullopt;
  const std::span<const RecordHealth* const> calm(order.data(), quiet), loud(order.data() + quiet, order.size() - quiet);
  double square = 0.0;
  for (const RecordHealth* h : loud) square += noise_N(h) * noise_N(h);
  const double found = std::sqrt(square / static_cast<double>(loud.size())), usual = noise_N(calm[calm.size() / 2]);
  const auto stand_still = std::ranges::count_if(loud, [&](const RecordHealth* h) { return std::min(own_noise_N(*h), h->scatter_F.still_N) > kOwn * noise_N(h); });
  if (found < kLeast * scales.range_N || noise_N(loud.back()) > kAlike * noise_N(loud.front()) || stand_still < static_cast<std::ptrdiff_t>(kFewest) ||
      middle_of_output_V(loud) > kOutputAlike * middle_of_output_V(calm))
    return std::nullopt;
  return claim_of(kProbability, found, "in " + std::to_string(loud.size()) + " of " + std::to_string(order.size()) + " records and by " + plain_number(usual) +
                                           " N in the others, while the output is as quiet in both");
}

}  // namespace

std::optional<HealthClaim> claim_of_reference_noise(const std::vector<RecordHealth>& health,
                                                    const HealthScales& scales, const BenchFacts& bench) {
  // of the range; a converter's step may be far below what an honest cell scatters by: 0.5 % of the range is what a data sheet promises
  constexpr double kLeast = 0.0025, kLeastBesideSteps = 0.004;
  // a step says less of the noise than a declared one would: what is about as large may be the noise of an honest cell;
  // where the output stands still nothing else scatters, and the measure is exact: less above what is declared is enough
  constexpr double kAbove = 2.0, kAboveSteps = 1.6, kAboveStill = 1.5;
  std::vector<double> noise, stood, ladder;
  double lsb_N = 0.0, lsb_V = 0.0;
  for (const RecordHealth& h : health) {
    if (!moves_throughout(h)) noise.push_back(own_noise_N(h));
    if (h.scatter_F.still_N > 0.0) stood.push_back(h.scatter_F.still_N);
    if (h.lsb_F_N > 0.0) ladder.push_back(std::min(h.lsb_F_N / std::sqrt(12.0), h.beside_line_N));
    lsb_N = std::max(lsb_N, h.lsb_F_N);
    lsb_V = std::max(lsb_V, h.lsb_U_V);
  }
  const bool noise_declared = std::isfinite(bench.reference_noise_N) && bench.reference_noise_N > 0.0,
             resolution_declared = std::isfinite(bench.reference_resolution_N);
  const double resolution = resolution_declared ? bench.reference_resolution_N : lsb_N;
  const double allowed =
      noise_declared ? std::hypot(bench.reference_noise_N, resolution / std::sqrt(12.0)) : resolution;
  // a value that stands between two codes comes out as either; a force that moves within one code of the output has not moved it
  const double hidden_V = 0.5 * lsb_V;
  const double allowed_still = std::hypot(std::max(allowed, 0.5 * resolution), scales.gain_V_per_N != 0.0 ? hidden_V / scales.gain_V_per_N : 0.0);
  // a force that moves fast is scatter too: the quieter records tell. A ladder of values in several records is exact, unless the output
  // moves by the same: the levels of a staircase are no codes
  const std::size_t several = std::min<std::size_t>(2, health.size());
  const double of_ladder = ladder.size() >= several ? quantile(ladder, 0.5) : 0.0;
  const double moving = std::max(2 * noise.size() < health.size() ? 0.0 : quantile(noise, 0.25), of_ladder);
  const double still =
      stood.size() * 2 >= std::min<std::size_t>(health.size(), 4) ? quantile(stood, 0.25) : 0.0;
  const bool scatters = noise_declared ? moving > kAbove * allowed || still > kAboveStill * allowed_still
                                       : resolution_declared && moving > kAboveSteps * allowed;
  const double found = noise_declared ? std::max(moving, still) : moving;
  if (auto claim = in_bursts(health, scales, allowed)) return claim;
  if (auto claim = in_some_records(health, scales)) return claim;
  if (!noise_declared && !resolution_declared) return undeclared(found, health, scales);
  if (!(allowed > 0.0) || !scatters || !(found > (noise_declared ? kLeast : kLeastBesideSteps) * scales.range_N)) return std::nullopt;
  return claim_of(0.93, found, "where " + plain_number(allowed) + " N are allowed");
}

}  // namespace forcegate::diagnose
