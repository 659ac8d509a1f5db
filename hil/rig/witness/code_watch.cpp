#include "hil/rig/witness/code_watch.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "hil/interface/rig.h"

namespace forcegate::witness {

void CodeWatch::push(const std::uint16_t* code, const std::uint16_t* status, const float* force_N, std::size_t n) {
  std::uint16_t low = low_, high = high_, any = 0, all = 0xFFFF, trouble = 0;
  for (std::size_t i = 0; i < n; ++i) {
    low = std::min(low, code[i]);
    high = std::max(high, code[i]);
    any |= code[i];
    all &= code[i];
    trouble |= status[i];
  }
  low_ = low;
  high_ = high;
  any_ |= any;
  all_ &= all;
  if (trouble == 0) return;
  for (std::size_t i = 0; i < n; ++i) {
    lost_ += (status[i] & kRigSampleLost) != 0;
    // A row is lost once: with an error, else saturated, else without a value (NoiseWatch). An ATI in overload may give no value.
    const bool fault = (status[i] & kRigReferenceFault) != 0;
    reference_fault_ += fault;
    reference_saturated_ += !fault && (status[i] & kRigReferenceSaturated) != 0 && (std::isfinite(force_N[i]) || (status[i] & kRigSampleLost) == 0);
    motor_fault_ += (status[i] & kRigMotorFault) != 0;
    travel_stop_ += (status[i] & kRigTravelStop) != 0;
    adc_rail_ += (status[i] & kRigAdcRail) != 0;
  }
}

void CodeWatch::finish(RigObservation& o) const {
  o.adc_min = low_;
  o.adc_max = high_;
  o.lost = lost_;
  o.reference_saturated = reference_saturated_;
  o.reference_fault = reference_fault_;
  o.motor_fault = motor_fault_;
  o.travel_stop = travel_stop_;
  o.adc_rail = adc_rail_;
  // A healthy converter toggles every bit below the highest one that its span needs.
  const unsigned span = high_ >= low_ ? high_ - low_ : 0u;
  const unsigned expected = span > 3 ? (std::bit_floor(span) - 1u) : 0u;
  o.adc_bits_stuck = static_cast<std::uint16_t>(~(any_ ^ all_) & expected);
}

}  // namespace forcegate::witness
