#pragma once
// How long the rows are that models see of a recording, and how many samples they need.

#include <algorithm>
#include <cmath>

namespace forcegate {

inline constexpr double kRowStep_s = 0.02;
inline constexpr double kFewestRows = 16.0;

/// Never less than one.
inline double samples_of_row(double sample_step_s, double row_step_s = kRowStep_s) { return std::max(1.0, std::round(row_step_s / sample_step_s)); }

}  // namespace forcegate
