#pragma once
// How long the rows of a record are to be.

#include <cstddef>

#include "hil/trace/campaign.h"

namespace forcegate {

/// In seconds: 0.02; of one recording alone as short as a five-thousandth of it. Halved while more than a tenth of the force's variance would lie
/// within rows, and either hangs together there or is followed by the output (noise does neither), down to its samples or to 40 000 rows over all
/// `records` that the campaign has: means over the swings of a fast load tell nothing of it.
double row_step_of(const Record& record, std::size_t records);

}  // namespace forcegate
