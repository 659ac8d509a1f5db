#pragma once
// Where the cells of a line begin, and what one of them says.

#include <string>
#include <string_view>
#include <vector>

namespace forcegate {

enum class CsvCell { number, missing, text };

/// Numbers with `point` as their decimal point (beside a decimal comma, a point makes it text), dates and times of day (as seconds, date_time.h). `out` is NaN for what is missing (empty,
/// "nan", "NA", "null", infinite by word or sign or beyond a double) or text.
CsvCell read_cell(std::string_view text, char point, double& out);

/// Whichever the decimal point.
bool is_number(std::string_view cell);

/// Neither a number nor missing, whichever the decimal point.
bool is_word(std::string_view cell);

/// Whether these may be the cells of a row: two numbers at least, and not more than half as many words ("idle" in a column of states).
bool is_row(const std::vector<std::string_view>& cells);

/// Without outer blanks and quotes.
std::string_view unquoted(std::string_view text);

/// The candidate that stands most often outside quotes: comma, semicolon, tab, bar; a blank where there is none of them. Commas that only stand
/// between a name and its unit ("x,mm") part no cells beside another candidate.
char choose_separator(std::string_view line);

/// Views into the line; quotes protect separators, blanks in a row are one.
void cut_cells(std::string_view line, char separator, std::vector<std::string_view>& cells);

/// The name of a column without quotes and outer blanks, its first 200 bytes. Bytes that are no UTF-8 are read as Latin-1 ("Winkel [\xB0]")
/// where that gives letters and signs; else they are replaced.
std::string header_text(std::string_view cell);

/// The first `most` bytes of any text in the same way.
std::string readable(std::string_view text, std::size_t most);

/// What a cell of a line of units holds: "[mN]", "(mN)", "in mN" as "mN", each also in quotes, in UTF-8 as header_text.
std::string unit_text(std::string_view cell);

/// "hh:mm:ss", "TT.MM.JJJJ hh:mm": how a program tells of its stamps where others have a unit.
bool is_form_of_stamps(std::string_view symbol);

}  // namespace forcegate
