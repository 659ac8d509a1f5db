#pragma once
// From the stamps in a file to a time base: order, gaps, rate.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/trace/trace.h"

namespace forcegate {

struct Clock {
  TimeBase base;
  std::vector<std::size_t> rows;  ///< rows to keep, in the order of time; empty = all as they are
  std::vector<std::string> notes;
};

/// Line of the file that a row stands in, for what is said of it.
using LineOfRow = std::function<std::uint64_t(std::size_t row)>;

/// Makes strictly increasing instants of the stamps. Rows without a stamp are dropped, rows out of order by at most
/// 10 steps are sorted, the second of two equal stamps is dropped, all noted; what a row without a stamp leaves open is a gap, but is not
/// told as one. A clock of day (0 to 86400 s) that falls from its last minute to its first goes on with the next day, noted. A step above 1.5 nominal ones is a
/// Gap; the nominal step is the median, or the mean where the stamps are rounded coarsely. When more than a tenth
/// of the steps are such gaps the clock counts as non-uniform: nominal_rate_Hz = 0 and no gaps are listed.
/// Errors (parse): no stamp at all, a clock that jumps back, one that stands still in more than 1 % of the rows.
Result<Clock> make_clock(std::vector<double> stamps_s, const std::string& where, const LineOfRow& line_of_row);

/// The base of strictly increasing instants, with the rate and the gaps that make_clock would find.
TimeBase with_rate_and_gaps(std::vector<double> t_s);

/// Row number over an assumed rate, for files without a clock.
TimeBase invented_clock(std::size_t rows, double rate_Hz);

}  // namespace forcegate
