#pragma once
// One recording is asked twice, with and without zeros of its parts.

#include "hil/diagnose/engine.h"

namespace forcegate::diagnose {

inline EngineOptions with_one_zero(EngineOptions options) {
  options.zero_wanders = false;
  return options;
}

/// A zero that wanders by itself and what a hold shows of creep look alike within a fifth of a recording. One zero for all is believed
/// where it describes the whole recording down to its noise, which no course of an effect does with a wander.
inline bool one_zero_is_enough(double plain_with_one, double plain_with_many, double floor) {
  constexpr double kFarBetter = 0.6;
  return plain_with_one < kFarBetter * plain_with_many && plain_with_one < kToItsNoise * floor;
}

}  // namespace forcegate::diagnose
