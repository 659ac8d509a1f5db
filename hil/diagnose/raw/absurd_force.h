#pragma once
// Samples of the reference that no force made: a lost byte, a counter that ran over, a glitch of the link. One of them is a bent curve to every fit.

#include <string>
#include <vector>

#include "hil/trace/campaign.h"

namespace forcegate::diagnose {

/// Makes samples of F_ref missing that lie ten spans (1 to 99 % of the record's samples) outside the span, where the output does not leave its
/// own span by as much as a tenth of it. A lowest or highest value that comes again (a logger's -9999) is in neither span. Says in `notes` how many, where and how far. A real blow moves the output.
void leave_out_absurd_force(Campaign& campaign, unsigned threads, std::vector<std::string>& notes);

}  // namespace forcegate::diagnose
