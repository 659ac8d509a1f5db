#pragma once
// The lines of a CSV file, one after the other, to a table.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/result.h"
#include "hil/trace/csv_cells.h"
#include "hil/trace/csv_table.h"

namespace forcegate {

/// Eats whole lines; a chunk always ends with '\n'.
class CsvParser {
 public:
  explicit CsvParser(std::string name) : name_(std::move(name)) {}
  Result<void> feed(std::string_view chunk, bool last_line_is_cut);
  void expect(std::size_t bytes_in_all, std::size_t bytes_so_far);
  Result<CsvTable> finish();

 private:
  /// `cut`: of the one line that ends with the file, and maybe short of its end.
  Result<void> lines(const char* p, const char* end, bool cut);
  Unexpected error(std::string text, std::size_t column, std::string hint) const;
  void skip_preamble(const char*& p, const char* end);
  void skip_lines(const char*& p, const char* end, std::size_t n);
  /// Lines of labelled_cells.h, whose labels are the names.
  Result<bool> take_labels(const char*& p, const char* end);
  /// Without the labels.
  void cut(std::string_view line);
  /// For who asks what the lines above the rows say.
  void keep_above(std::string_view line);
  Result<void> check_kind(std::string_view chunk) const;
  /// "# t_s F_ref_N U_V" above the first row, as numpy writes it, is the header.
  bool comment_names(std::string_view row);
  Result<void> header(std::string_view line);
  /// A row of plain numbers, nullptr for anything else.
  const char* fast_row(const char* p);
  Result<void> slow_row(std::string_view line, bool cut_short);
  /// A cell of a column of dates.
  void read_day(std::size_t c, CsvCell kind);
  Result<void> check_zone(std::size_t c, std::size_t position) const;
  void read_word(std::size_t c, CsvCell kind);
  Result<bool> row_of_units(std::string_view line);
  /// To a header that does not tell it already; one that tells another is an error.
  Result<void> add_unit(std::string& header, std::string_view symbol, std::size_t column) const;
  /// "X,CH1,Start,Increment" above "Sequence,VOLT,0.0,2e-2": units, and the time of row number X.
  bool row_of_oscilloscope();
  void time_by_increment();
  static bool says_no_unit(std::string_view symbol);
  /// One known unit at least, and nothing that looks like a sample.
  bool holds_units() const;
  bool is_header_again();
  /// A file may end without a line end, or inside its last number: the row goes where that number is not whole, or is further from the one
  /// above than any two others are ("1" of 15.2).
  void drop_cut_row(std::string_view line);
  /// The first number that has decimals tells what parts them; whole numbers before it mean the same either way.
  void settle_point();
  bool has_decimal_comma(std::size_t column) const;

  std::string name_;
  CsvTable table_;
  std::vector<std::string_view> cells_;
  std::vector<double> row_;
  std::vector<char> is_text_;
  std::vector<char> is_day_;  ///< a column of text whose cells are dates so far
  std::vector<TextColumn> text_;
  std::vector<std::string> names_;  ///< without units of a second line
  std::vector<std::string> labels_;  ///< before every number; empty in other files
  std::string comment_;             ///< the last one above the header
  std::string unit_labels_;         ///< a line above the header
  std::uint64_t repeats_ = 0, first_repeat_ = 0, last_repeat_ = 0;
  std::size_t trailing_ = 0;
  std::size_t short_rows_ = 0;  ///< between blanks
  std::uint64_t first_short_line_ = 0;
  Error first_short_row_;
  std::size_t words_below_names_ = 0;  ///< lines of them that are still to come
  double scope_start_s_ = 0.0, scope_step_s_ = 0.0;  ///< the second is 0 for all but an oscilloscope's file
  std::uint64_t line_ = 0;
  char separator_ = ',', point_ = '.';
  bool started_ = false, has_header_ = false, seen_data_ = false, point_settled_ = false;
};

}  // namespace forcegate
