#pragma once
// A header's constants are of one sampling rate. What it runs at is the firmware's; recordings say at which rate the sensor was sampled so far.

#include <string>

#include "hil/trace/campaign.h"

namespace forcegate {

/// Samples a second of the output of every record, where they agree within 1 %; 0: they do not, or a clock is not uniform.
double recorded_rate_Hz(const Campaign& campaign);

/// Whether the header would be called at another rate than it is made for by a firmware that samples as the records were.
bool is_other_rate(double header_Hz, double recorded_Hz);

/// The sentence for it; "" where it is the same or not known.
std::string note_of_rate(double header_Hz, double recorded_Hz);

}  // namespace forcegate
