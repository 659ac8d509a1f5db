#include "hil/diagnose/raw/sample_marks.h"

#include <algorithm>
#include <cmath>

namespace forcegate::diagnose {

void SampleMarks::mark(std::size_t i, BadSample why, double error_V) {
  if (why == BadSample::zero && belongs_at_floor(i)) return;
  // a logger's 9.9e37 is as far off as the output can be
  const double declared_V = std::isfinite(scales_.high_V) ? scales_.high_V - scales_.low_V : 0.0;
  const double error = std::min(std::abs(error_V), std::max(scales_.U_range_V, declared_V));
  if (at(i) == BadSample::none) square_V2_ += error * error;
  why_[i] = static_cast<std::uint8_t>(why);
}

bool SampleMarks::belongs_at_floor(std::size_t i) {
  constexpr double kNear = 0.005, kOfNoise = 3.0;  // kNear: of the range
  if (!floor_)
    floor_.emplace(samples_.F_N(), samples_.U_V(), scales_.low_V + scales_.lsb_U_V + 1e-9,
                   std::max(kOfNoise * scales_.noise_F_N, kNear * scales_.range_N));
  return floor_->belongs_there(samples_.F_N()[i]);
}

}  // namespace forcegate::diagnose
