#pragma once
// How much of what smoothing took from the reference the output followed. Noise of the reference moves it alone; a force that was too
// quick for the windows moves the output too, and without it a peak is flat, which looks like a curve, a dead zone or a loop of the sensor.
//
//   U = a + b t + g (F' + s (F - F')),  F' smoothed, by least squares;  a, b, g of each stretch of samples (the swing decays), s of the record
//
// s = 0: noise alone; 1: force alone.

#include <cstdint>
#include <span>
#include <vector>

namespace forcegate::diagnose {

struct SharedPart {
  double share = 0.0;           ///< s
  double standard_error = 0.0;  ///< of s; infinite where the samples do not tell
  double taken_N2 = 0.0;        ///< mean square of F - F'
};

SharedPart shared_with_output(std::span<const double> recorded_N, std::span<const double> smoothed_N, std::span<const double> U_V,
                              std::span<const std::uint8_t> bad);

}  // namespace forcegate::diagnose
