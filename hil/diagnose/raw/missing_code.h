#pragma once
// A logger's word for "no value" among the samples of the output: -9999 and the like. One of them outweighs all others in every fit.

#include <string>
#include <vector>

#include "hil/trace/campaign.h"

namespace forcegate::diagnose {

/// Whether the digits are nines alone, three of them at least (-9999, 999.9, in whatever unit), or the number is beyond 1e30.
bool is_code_for_missing(double value);

/// Makes samples of U missing that are such a code and lie further outside the span of all others (1 to 99 % of the record's samples) than that is
/// wide. Says in `notes` which, how many and where.
void leave_out_missing_codes(Campaign& campaign, std::vector<std::string>& notes);

}  // namespace forcegate::diagnose
