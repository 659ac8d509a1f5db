#pragma once
// The numbers of a CSV file, column by column, before anybody gives them a meaning.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/result.h"

namespace forcegate {

struct CsvColumn {
  std::string header;  ///< as written, without quotes and outer blanks; a row of units is appended as "_mN"
  std::vector<double> value;  ///< NaN = missing
  bool dates = false;         ///< its cells are dates or times of day, and the values seconds
  bool zoned = false;         ///< and tell their zone, all of them
  std::size_t missing = 0;    ///< empty cells, "nan", "NA", "null", infinities
};

/// Different cells of a column of text that are kept; of more it is a remark.
inline constexpr std::size_t kMostWords = 64;

/// A column whose first cell is no number.
struct TextColumn {
  std::string header, cell;  ///< cell: its first 40 bytes
  std::string hint;          ///< how to make it a number
  std::uint64_t line = 0, position = 0;  ///< of that cell; position: its first byte in the line, from 1
  std::vector<double> day_s;  ///< where every cell is a date, or empty: the beginning of the day, seconds since 1970; NaN = missing
  std::vector<std::string> words;        ///< the different cells, "" for a missing one; empty where they are more than kMostWords
  std::vector<std::uint8_t> word_of_row;  ///< index into `words`
};

struct CsvTable {
  std::vector<CsvColumn> columns;
  std::vector<TextColumn> text_columns;
  std::vector<std::string> notes;            ///< what was unusual about the file, one sentence each
  std::vector<std::string> above;            ///< comments and whatever else stands above the rows: the first 200 bytes of 50 lines at most
  std::vector<std::uint64_t> skipped_lines;  ///< numbers of blank and comment lines after the header
  std::uint64_t header_line = 1;             ///< 0: the table comes from no text

  std::size_t rows() const { return columns.empty() ? 0 : columns.front().value.size(); }
  std::uint64_t line_of_row(std::size_t row) const;
};

/// One header line, then rows of numbers. Separator comma, semicolon, tab, bar or blanks (the one that the header
/// uses); decimal point, or decimal comma where the separator is another one or the cells are quoted. Accepted: UTF-16, line ends of every kind,
/// lines that begin with '#', blank lines, quotes, a second line of units, names that stand again, empty cells, dates and
/// times of day (as seconds, date_time.h). A column of text is left out and a last line cut short is dropped, both noted; of dates without times who reads the table tells. Two columns of one
/// name are an error. Errors (parse) name file:line:column, column in bytes from 1.
/// Reads about as fast as std::from_chars over the mapped file; memory is that of the columns and 1 MB, of UTF-16 and CR alone that of the text too.
Result<CsvTable> read_csv_table(const std::filesystem::path& path);

/// The same from memory; `name` stands for the file in errors.
Result<CsvTable> parse_csv_table(std::string_view bytes, std::string_view name);

}  // namespace forcegate
