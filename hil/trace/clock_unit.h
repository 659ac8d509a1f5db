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
/// a date of this century, less than a millisecond apart (20 microseconds where they were called seconds), are noted.
Result<ClockUnit> unit_of_clock(const std::vector<double>& stamps, const std::string& column, bool assumed, double declared_rate_Hz, const std::string& where);

/// "--map time=t_us" out of the first note of a clock without a unit that as seconds would have a sample every 1000 s or more; "": none is.
std::string map_of_clock(const std::vector<std::string>& notes);

/// Whether a spreadsheet would show every one of the numbers as a date between 2000 and 2100, and they lie less than a thousandth of a day apart.
bool may_count_days(const std::vector<double>& stamps);

/// A counter of 32 bits begins anew behind 2^32 - 1 (micros() after 71.6 minutes, millis() after 49.7 days), one of 16 bits behind 65535: whole numbers
/// that fall from there to 0 within 100 typical steps (2 of 16 bits) are counted on. Returns the bits; 0, and nothing changed, where there is no such fall.
int count_on(std::vector<double>& stamps);

}  // namespace forcegate
