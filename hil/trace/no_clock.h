#pragma once
// What to say of a table in which no column is the clock, and no rate was given.

#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/trace/columns.h"
#include "hil/trace/csv_table.h"

namespace forcegate {

/// The columns that are there, those that were left out because they hold text with what they hold, and what to do: the likeliest clock with a
/// unit that its numbers may have ("t_days" where a spreadsheet would show them as dates of this century), else a rate. `meanings`: of the columns.
Unexpected no_clock(const CsvTable& table, const std::vector<ColumnMeaning>& meanings, const std::string& where);

}  // namespace forcegate
