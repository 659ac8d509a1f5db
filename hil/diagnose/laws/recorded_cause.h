#pragma once
// Whether a channel that is recorded beside the force tells more of the output than time does.

#include "hil/trace/campaign.h"

namespace forcegate::diagnose {

/// A straight line in the channel predicts tenths of the record that were left out clearly better than every law of time, and the channel
/// moves. False where the record lacks the channel or an output.
bool tells_of_output(const Record& record, const char* channel);

}  // namespace forcegate::diagnose
