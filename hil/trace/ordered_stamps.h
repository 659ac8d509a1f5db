#pragma once
// The stamps of a file in the order of time: those that are missing, out of order, repeated or of the reading.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/trace/bursts.h"

namespace forcegate {

/// Line of the file that a row stands in, for what is said of it.
using LineOfRow = std::function<std::uint64_t(std::size_t row)>;

/// Where stamps come from.
struct ClockSource {
  std::string where;   ///< file
  std::string column;  ///< as its header writes it
  LineOfRow line_of_row;  ///< none: the table comes from no text, and rows are counted
  double declared_rate_Hz = 0.0;  ///< 0 = not said
  bool dates = false;  ///< its cells are stamps such as 2024-05-31T10:31:07, which errors then write
  bool zoned = false;  ///< and tell their zone
  OtherColumns columns;
  std::function<std::string(std::size_t row)> changes_at;  ///< header of a column with one value before that row and another from it on, or ""
};

/// A clock of day begins anew at midnight: stamps (s) within one day that fall from its last minute to its first go on with the next. Days that
/// were added.
std::size_t count_midnights(std::vector<double>& stamps_s);
std::string note_of_midnights(std::size_t days);

struct OrderedStamps {
  std::vector<double> t_s;        ///< strictly increasing
  std::vector<std::size_t> rows;  ///< to keep, in the order of time; empty = all as they are
  std::vector<std::string> notes;
};

/// What make_clock (time_base.h) says of order, repetitions and bursts, with its errors. Stamps in good order are moved out of `stamps_s`; others
/// stay there, counted on over midnight.
Result<OrderedStamps> order_stamps(std::vector<double>& stamps_s, const ClockSource& source);

}  // namespace forcegate
