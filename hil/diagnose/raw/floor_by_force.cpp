#include "hil/diagnose/raw/floor_by_force.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace forcegate::diagnose {

FloorByForce::FloorByForce(std::span<const double> F, std::span<const double> U, double floor_V, double near_N) : near_N_(near_N) {
  std::vector<std::pair<double, bool>> samples;
  for (std::size_t i = 0; i < F.size(); ++i)
    if (std::isfinite(F[i] + U[i])) samples.emplace_back(F[i], U[i] <= floor_V);
  std::ranges::sort(samples);
  at_low_.push_back(0);
  for (const auto& [force, low] : samples) {
    F_.push_back(force);
    at_low_.push_back(at_low_.back() + (low ? 1 : 0));
  }
}

bool FloorByForce::belongs_there(double F_N) const {
  constexpr double kAtForce = 0.3, kBelow = 0.5;
  const auto begin = std::ranges::lower_bound(F_, F_N - near_N_) - F_.begin(), end = std::ranges::upper_bound(F_, F_N + near_N_) - F_.begin();
  const auto low_up_to = [&](std::ptrdiff_t k) { return static_cast<double>(at_low_[static_cast<std::size_t>(k)]); };
  return end > begin && low_up_to(end) - low_up_to(begin) >= kAtForce * static_cast<double>(end - begin) && low_up_to(end) >= kBelow * static_cast<double>(end);
}

}  // namespace forcegate::diagnose
