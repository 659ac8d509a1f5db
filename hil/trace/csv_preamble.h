#pragma once
// Lines that a measuring program writes above the table.

#include <cstddef>
#include <string_view>

namespace forcegate {

/// How many physical lines stand above the header of a table, where that is unmistakable: the header is the first line of names that two
/// rows of as many numbers follow (a row of units may lie between), and the line above it has another number of cells or no line above
/// could be a row. 0 for every other text. `text` holds whole lines; the first 200 that are neither blank nor comment are looked at.
std::size_t lines_above_header(std::string_view text);

/// How many lines stand between the names in the first line (that is neither blank nor comment) and a row of units: lines of words with as many cells
/// ("ATI Nano17", "FlexiForce"), at most three, followed by the units and a row of numbers. 0 for every other text.
std::size_t lines_of_words_below_names(std::string_view text);

/// LabVIEW ends the names of its columns with it, and no row has it that holds no comment.
inline constexpr std::string_view kMayBeShort = "comment";

}  // namespace forcegate
