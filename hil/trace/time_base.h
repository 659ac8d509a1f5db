#pragma once
// From the stamps in a file to a time base: order, gaps, rate.

#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/trace/ordered_stamps.h"
#include "hil/trace/trace.h"

namespace forcegate {

struct Clock {
  TimeBase base;
  std::vector<std::size_t> rows;  ///< rows to keep, in the order of time; empty = all as they are
  std::vector<std::string> notes;
};

/// Makes strictly increasing instants of the stamps. Rows without a stamp are dropped, rows out of order by at most
/// 10 steps are sorted, the second of two equal stamps is dropped, all noted; where more than 1 % of the rows repeat a stamp they are spread between
/// the stamps (packets.h), noted, unless each of them repeats every value too while the values change from stamp to stamp: such rows are copies, and dropped.
/// Rows that were stamped when they were read, in bursts, are spread as well (bursts.h), noted. What a row without a stamp leaves open is a gap, but is not
/// told as one. A clock of day (0 to 86400 s) that falls from its last minute to its first goes on with the next day, noted.
/// The nominal step is the median, or the mean where the stamps are rounded coarsely. A Gap is a step above 1.5 nominal ones that stands five standard
/// deviations out of the jitter of the stamps, and that the step before or behind does not make up for. Jitter of 5 to 25 % of a period is noted. When more
/// than a tenth of the steps are above 1.5 nominal ones and it is not jitter the clock counts as non-uniform: nominal_rate_Hz = 0 and no gaps are listed.
/// Errors (parse): no stamp at all, a clock that jumps back, one that stands still in more than 1 % of the rows.
Result<Clock> make_clock(std::vector<double> stamps_s, const ClockSource& source);

/// The base of strictly increasing instants, with the rate and the gaps that make_clock would find.
TimeBase with_rate_and_gaps(std::vector<double> t_s);

/// Row number over an assumed rate, for files without a clock.
TimeBase invented_clock(std::size_t rows, double rate_Hz);

}  // namespace forcegate
