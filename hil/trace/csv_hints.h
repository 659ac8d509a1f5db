#pragma once
// How to mend a file that cannot be read as a table.

#include <string>
#include <string_view>
#include <vector>

namespace forcegate {

/// How the hint for a date begins that may be of two days, that for a stamp of a time that does not exist, and that for a minus of typesetters.
inline constexpr std::string_view kWhichIsTheMonth = "which number is the month", kNoSuchTime = "there is no such time", kTypographicMinus = "its minus sign is the typographical one";

/// The first 40 bytes, printable and in quotes.
std::string in_quotes(std::string_view text);

/// For a cell that is no number in a file whose decimals follow `point`; `is_settled`: a number before it told so.
std::string hint_for_cell(std::string_view cell, char point, bool is_settled = true);

/// For a line whose number of cells is not `columns`. `seen_data`: rows were read before it.
std::string hint_for_line(std::string_view line, const std::vector<std::string_view>& cells, std::size_t columns, char separator, bool seen_data);

/// For a line below the rows that holds words only.
inline constexpr const char* kNoRow = "what is no row does not belong here: take the line out, or put # before it; where another table begins, it belongs in a file of its own";

/// "a semicolon"
std::string separator_in_words(char separator);

}  // namespace forcegate
