#include "hil/app/gate/same_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "hil/base/quantile.h"

namespace forcegate {

namespace {

struct Course {
  double low_N = 0.0, median_N = 0.0, high_N = 0.0;
  double crossings = 0.0;
};

Course course_of(const Stimulus& stimulus, double duration_s) {
  constexpr double kStep_s = 0.01, kBand = 0.2;  // of the swing, so that noise crosses nothing
  std::vector<double> force_N(static_cast<std::size_t>(std::max(1.0, duration_s / kStep_s)));
  stimulus.fill(0.0, kStep_s, force_N.size(), force_N.data());
  Course out;
  const auto [low, high] = quantiles(force_N, 0.1, 0.9);
  out.low_N = low, out.high_N = high, out.median_N = median(force_N);
  int side = 0;
  for (const double f : force_N) {
    const double x = f - 0.5 * (low + high), band_N = kBand * (high - low);
    const int now = x > band_N ? 1 : x < -band_N ? -1 : side;
    if (side != 0 && now != side) out.crossings += 1.0;
    side = now;
  }
  return out;
}

}  // namespace

std::string other_profile(const Stimulus& planned, const Stimulus& recorded) {
  constexpr double kOfForce = 0.1, kOff_N = 0.1, kOfRate = 0.15, kOff = 2.0;
  const double duration_s = std::min(planned.duration_s(), recorded.duration_s());
  const Course plan = course_of(planned, duration_s), here = course_of(recorded, duration_s);
  const double tolerance_N = kOfForce * std::abs(plan.high_N) + kOff_N;
  for (const auto& [what, of] : {std::pair{"median force", &Course::median_N}, std::pair{"high force (90 % of the time below)", &Course::high_N}, std::pair{"low force (10 % of the time below)", &Course::low_N}})
    if (!(std::abs(here.*of - plan.*of) <= tolerance_N)) return fmt::format("its {} is {:.3g} N, the plan's {:.3g} N", what, here.*of, plan.*of);
  if (std::abs(here.crossings - plan.crossings) > kOfRate * plan.crossings + kOff)
    return fmt::format("it crosses its middle {:.3g} times in {:.0f} s, the plan's {:.3g}", here.crossings, duration_s, plan.crossings);
  return {};
}

}  // namespace forcegate
