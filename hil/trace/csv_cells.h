#pragma once
// Where the cells of a line begin, and what one of them says.

#include <string_view>
#include <vector>

namespace forcegate {

enum class CsvCell { number, missing, text };

/// Numbers with `point` as their decimal point, dates and times of day (as seconds, date_time.h). `out` is NaN for what is missing (empty,
/// "nan", "NA", "null", beyond a double) or text.
CsvCell read_cell(std::string_view text, char point, double& out);

/// The candidate that stands most often outside quotes: comma, semicolon, tab, bar; a blank where there is none of them.
char choose_separator(std::string_view line);

/// Views into the line; quotes protect separators, blanks in a row are one.
void cut_cells(std::string_view line, char separator, std::vector<std::string_view>& cells);

/// "[mN]", "(mN)" and "mN" in quotes as "mN".
std::string_view strip_brackets(std::string_view symbol);

}  // namespace forcegate
