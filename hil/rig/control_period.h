#pragma once
// The period of the controllers on a rig: 10 ms, or as near as its whole samples come.

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace forcegate {

inline constexpr double kControlPeriod_s = 0.01;

struct ControlPeriod {
  std::size_t samples = 1;  ///< round(kControlPeriod_s rate), at least one
  double s = 0.0;           ///< samples / rate: 12 ms at 250 Hz
};

/// rate_Hz > 0, of the rig's rows.
inline ControlPeriod control_period(double rate_Hz) {
  const auto samples = std::max<std::size_t>(1, static_cast<std::size_t>(std::llround(kControlPeriod_s * rate_Hz)));
  return {samples, static_cast<double>(samples) / rate_Hz};
}

}  // namespace forcegate
