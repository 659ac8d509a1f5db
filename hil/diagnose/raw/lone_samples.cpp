#include "hil/diagnose/raw/lone_samples.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "hil/diagnose/raw/short_spikes.h"

namespace forcegate::diagnose {

namespace {

double middle_of_four(double a, double b, double c, double d) {
  const double low = std::min(std::min(a, b), std::min(c, d)),
               high = std::max(std::max(a, b), std::max(c, d));
  return 0.5 * (a + b + c + d - low - high);
}

// What stays is an edge, or held samples that were let go, and what its neighbours climb to is a peak.
bool stands_alone(const std::vector<double>& U, std::size_t i, double jump_V) {
  constexpr double kStays = 0.6, kClimbs = 0.8;  // of the jump
  return std::abs(U[i + 1] - U[i - 1]) < kStays * jump_V &&
         std::abs(U[i - 1] + U[i + 1] - U[i - 2] - U[i + 2]) < kClimbs * jump_V;
}

}  // namespace

OffTheirNeighbours find_lone_samples(const ForceAndOutput& samples, const StepsOfOutput& steps, const RecordScales& scales) {
  const std::vector<double>&F = samples.F_N(), &U = samples.U_V();
  OffTheirNeighbours out;
  const auto add = [](LoneSamples& to, std::size_t i, double level_V) {
    to.at.push_back(i);
    to.level_V.push_back(level_V);
  };
  for (std::size_t i = 2; i + 2 < samples.size(); ++i) {
    if (!std::isfinite(U[i])) continue;
    const double level_V = middle_of_four(U[i - 2], U[i - 1], U[i + 1], U[i + 2]), jump_V = std::abs(U[i] - level_V);
    if (!(jump_V > scales.quiet_V)) continue;
    const auto [low_N, high_N] = spread_of_present({&F[i - 2], 5});
    if (!steps.exceeds(jump_V, high_N - low_N)) continue;
    if (std::abs(U[i] - scales.low_V) < 1e-9 + scales.lsb_U_V) {
      if (steps.calm_before(i) || steps.calm_behind(i + 1, U[i])) add(out.at_low_end, i, level_V);
    } else if (stands_alone(U, i, jump_V) && jump_V > kAboveAround * scatter_around(U, i)) {
      add(out.spikes, i, level_V);
    }
  }
  return out;
}

}  // namespace forcegate::diagnose
