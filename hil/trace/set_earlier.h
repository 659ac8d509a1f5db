#pragma once
// An output that is known to be late behind the force: two loggers, one start; a filter with a dead time.

#include "hil/trace/campaign.h"

namespace forcegate {

/// Sets the output of every record `late_s` earlier (later where negative; 0: nothing) and puts it on the clock of the others anew, along straight
/// lines; what it has no sample for is missing. A note says so. Errors (config): a record is no longer than that.
Result<void> set_output_earlier(Campaign& campaign, double late_s);

}  // namespace forcegate
