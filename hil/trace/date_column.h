#pragma once
// A date in a column of its own beside a time of day.

#include <string>
#include <vector>

#include "hil/trace/csv_table.h"

namespace forcegate {

/// Adds the dates of a column to a clock of times of day (seconds since midnight), so that the clock counts from 1970 and records of several
/// days have their order. A cell without a date has that of the row above. One date for all rows is that of the first: midnights are counted on
/// before. Of several columns of dates the one that is called so. The column is taken out of `text_columns`, as those are that
/// somebody took out; what was done, or that a column of text is left out, is noted.
/// `clock`: nullptr, there is none; `unused`: headers of columns that somebody took out.
void add_dates(std::vector<TextColumn>& text_columns, CsvColumn* clock, const std::vector<std::string>& unused, std::vector<std::string>& notes);

}  // namespace forcegate
