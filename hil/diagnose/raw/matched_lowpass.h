#pragma once
// The output behind the same low-pass as the reference. A filter that only F_ref goes through lets the output lead, and what is quick in the force is
// missing in F_ref: whatever answers to the rate would be taken for an effect of the sensor.

#include <cstdint>
#include <span>

#include "hil/trace/campaign.h"

namespace forcegate::diagnose {

/// Takes the channel U through tau dy/dt + y = U, tau = 1 / (2 pi f), f = `corner_Hz` > 0, each sample held from the one before it on: if anything the output
/// is early by half a sample beside a filter of straight lines, as a reference that is a little late lets it be. Samples that are missing or marked
/// in `bad` (one mark for each, or none) change nothing. For 5 tau after the first one, and after a stretch without any that is longer than tau / 10 and three samples, the
/// output is missing (NaN), for what the filter held is not known.
void match_reference_lowpass(Record& record, std::span<const std::uint8_t> bad, double corner_Hz);

}  // namespace forcegate::diagnose
