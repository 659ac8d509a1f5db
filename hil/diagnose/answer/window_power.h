#pragma once
// Power of the waves of a window of rows.

#include <array>
#include <cstddef>
#include <numbers>
#include <span>

#include "hil/base/portable_math.h"

namespace forcegate::diagnose {

inline constexpr std::size_t kPowerWindow = 256;  ///< rows

/// Square of the sum of x_i exp(-2 pi i k/256) for k = 1 to 127 (Goertzel 1958); 0 for k = 0. As many rows as a window has.
inline std::array<double, kPowerWindow / 2> window_power(std::span<const double> x) {
  std::array<double, kPowerWindow / 2> out{};
  for (std::size_t k = 1; k < out.size(); ++k) {
    const double turn = 2.0 * portable::cos(2.0 * std::numbers::pi * static_cast<double>(k) / kPowerWindow);
    double now = 0.0, before = 0.0;
    for (const double v : x) {
      const double next = v + turn * now - before;
      before = now;
      now = next;
    }
    out[k] = now * now + before * before - turn * now * before;
  }
  return out;
}

}  // namespace forcegate::diagnose
