#pragma once

#include <cstddef>
#include <cstdint>

#include "hil/rig/rig_observation.h"

namespace forcegate::witness {

/// Range of the converter's codes, bits that never change, and how often each status bit was set.
class CodeWatch {
 public:
  void push(const std::uint16_t* code, const std::uint16_t* status, const float* force_N, std::size_t n);
  void finish(RigObservation& o) const;

 private:
  std::uint16_t low_ = 0xFFFF, high_ = 0, any_ = 0, all_ = 0xFFFF;
  std::uint64_t lost_ = 0, reference_saturated_ = 0, reference_fault_ = 0, motor_fault_ = 0, travel_stop_ = 0, adc_rail_ = 0;
};

}  // namespace forcegate::witness
