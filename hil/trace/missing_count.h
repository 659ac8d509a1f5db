#pragma once
// A whole number has no NaN: what stands in Channel::raw where a count is missing.

#include <cstdint>
#include <limits>

#include "hil/trace/trace.h"

namespace forcegate {

/// No converter gives it; one with a sign (HX711) gives every other number below zero.
inline constexpr std::int32_t kMissingCount = std::numeric_limits<std::int32_t>::min();

inline double value_of_count(std::int32_t count) { return count == kMissingCount ? kMissing : count; }

}  // namespace forcegate
