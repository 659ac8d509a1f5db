#pragma once
// Two loggers that were started by hand.

#include "hil/model/record_input.h"

namespace forcegate {

/// By how much the output is late where it goes best with the force, one shift for all records, s; negative: early. Correlation of the rows on an even
/// grid, records by the variance of their output, to a quarter of a record and a minute; an output that falls with the force counts where it fits far
/// better. 0 where no shift of half a second and more halves what a straight line leaves without one; of several that are as good, as of cycles,
/// the smallest.
double shift_of_start(const CampaignInput& campaign);

}  // namespace forcegate
