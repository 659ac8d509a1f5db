#pragma once
// What the numbers of a clock count where the header does not say it, or cannot be believed.

#include <string>
#include <vector>

#include "hil/base/result.h"

namespace forcegate {

struct ClockUnit {
  double factor = 1.0;  ///< seconds = factor * number
  std::string note;     ///< empty when there is nothing to tell
};

/// Of stamps that were taken for seconds, by the header `column` or because it has no unit (`assumed`). Numbers that would be a date beyond
/// the year 5000 are milli-, micro- or nanoseconds since 1970 where that is a date of this century, noted; else an error (parse). Whole numbers
/// at least 2 apart without a unit are what the declared rate (0: none) says, else seconds with a note. Numbers that a spreadsheet would show as
/// a date of this century, less than a millisecond apart, are noted.
Result<ClockUnit> unit_of_clock(const std::vector<double>& stamps, const std::string& column, bool assumed, double declared_rate_Hz, const std::string& where);

}  // namespace forcegate
