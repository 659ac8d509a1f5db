#include "hil/diagnose/raw/falls_to_floor.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace forcegate::diagnose {

namespace {

// What the record has above its lowest level.
struct Above {
  double lowest_V = std::numeric_limits<double>::infinity();
  Spread force_N{lowest_V, -lowest_V};

  Above(std::span<const double> F, std::span<const double> U, double floor_V) {
    for (std::size_t i = 0; i < U.size(); ++i)
      if (U[i] > floor_V) {
        lowest_V = std::min(lowest_V, U[i]);
        force_N = {std::min(force_N.low, F[i]), std::max(force_N.high, F[i])};
      }
  }
};

// Down and up again, though the force stays where it is, before and after too; or though elsewhere the output is plainly above at less force
// and at more.
bool comes_back(std::span<const double> F, std::span<const double> U, const StepsOfOutput& steps, const Fall& fall, const Above& above, double least_V) {
  if (fall.begin < 2 || fall.end + 2 > U.size() || !(steps.calm_before(fall.begin) || steps.calm_behind(fall.end, U[fall.begin]))) return false;
  const double floor_V = std::max(U[fall.begin], U[fall.end - 1]), by = std::min(U[fall.begin - 1], U[fall.end]) - floor_V;
  const auto [low, high] = spread_of_present(F.subspan(fall.begin - 2, fall.end - fall.begin + 4));
  const bool elsewhere_above = above.lowest_V > floor_V + least_V && above.force_N.low < low && high < above.force_N.high;
  return by > least_V && (elsewhere_above || steps.exceeds(by, high - low));
}

}  // namespace

std::vector<Fall> falls_to_floor(std::span<const double> F, std::span<const double> U, const StepsOfOutput& steps, double near_V, double range_V) {
  constexpr double kDeep = 0.05, kMost = 0.05;
  const double floor_V = spread_of_present(U).low;
  const Above above(F, U, floor_V + near_V);
  std::vector<Fall> out;
  std::size_t longest = 0, samples = 0;
  for (std::size_t i = 0; i < U.size(); ++i) {
    if (!(U[i] <= floor_V + near_V)) continue;
    Fall fall{i, i + 1};
    while (fall.end < U.size() && U[fall.end] <= floor_V + near_V) ++fall.end;
    if (!comes_back(F, U, steps, fall, above, kDeep * range_V)) return {};
    longest = std::max(longest, fall.end - fall.begin);
    samples += fall.end - fall.begin;
    out.push_back(fall);
    i = fall.end;
  }
  const bool lost = longest > 1 && static_cast<double>(samples) < kMost * static_cast<double>(U.size());
  return lost ? out : std::vector<Fall>{};
}

}  // namespace forcegate::diagnose
