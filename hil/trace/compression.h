#pragma once
// The sign of a force. Load cells that count tension write compression as a negative number.

#include "hil/trace/campaign.h"
#include "hil/trace/csv.h"

namespace forcegate {

/// Laws and effects are of a force that presses, F >= 0. A force (F_ref, F_cmd, each for itself) that is below zero wherever it is not small, in
/// every record, is turned over, with a note: where all but a hundredth of its samples end below a twentieth of how far down a hundredth of them
/// reach. One that goes both ways stays.
void turn_compression_over(Campaign& campaign, unsigned threads);
void turn_compression_over(TraceFile& file);

}  // namespace forcegate
