#pragma once
// How long the rows of a campaign are to be.

#include "hil/trace/campaign.h"

namespace forcegate {

/// In seconds: 0.02. Of one recording as short as a five-thousandth of it, and halved while more than a tenth of the force's variance would lie
/// within rows, and either hangs together there or is followed by the output (noise does neither), down to its samples or to 40 000 rows: means over
/// the swings of a fast load tell nothing of it.
double row_step_of(const Campaign& campaign);

}  // namespace forcegate
