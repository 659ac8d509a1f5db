#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "hil/interface/rig.h"
#include "hil/rig/rig_observation.h"

namespace forcegate::witness {

/// Range, mean and noise of the reference's force. Noise: standard deviation from second differences,
/// sqrt(mean (x[i-1] - 2 x[i] + x[i+1])^2 / 6); the motion of the profile drops out, the noise of a sound reference and its
/// quantisation remain.
class NoiseWatch {
 public:
  template <bool kSound>
  void push(const RigBlock& block, std::size_t n);
  /// Range +inf to -inf, mean and noise 0 without a valid force.
  void finish(RigObservation& o) const;

 private:
  double low_N_ = std::numeric_limits<double>::infinity(), high_N_ = -std::numeric_limits<double>::infinity();
  double sum_N_ = 0.0, sum_second_ = 0.0;
  std::uint64_t n_ = 0, second_n_ = 0, not_finite_ = 0;
  float x1_ = 0.0f, x2_ = 0.0f;
  int run_ = 0;  ///< valid rows before this one
};

}  // namespace forcegate::witness
