// What stands in a CSV file beside its rows: kind, header, units, and both once more.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "hil/base/text.h"
#include "hil/base/units.h"
#include "hil/trace/channels.h"
#include "hil/trace/columns.h"
#include "hil/trace/csv_cells.h"
#include "hil/trace/csv_hints.h"
#include "hil/trace/csv_parser.h"
#include "hil/trace/csv_preamble.h"
#include "hil/trace/date_time.h"
#include "hil/trace/labelled_cells.h"
#include "hil/trace/missing_count.h"

namespace forcegate {
namespace {

constexpr std::size_t kMostColumns = 4096;

/// What the name of a column says of its unit beside what a line of units says.
enum class NameOfUnit { nothing, same, another };

NameOfUnit unit_in_name(const std::string& header, std::string_view symbol) {
  const ColumnMeaning named = meaning_of(header);
  if (named.unit.symbol.empty() || named.name.empty() || named.name.size() == header.size()) return NameOfUnit::nothing;
  const Unit &a = named.unit, b = meaning_of(named.name + "_" + std::string(symbol)).unit;
  if (a.quantity == b.quantity) return a.factor == b.factor && a.offset == b.offset ? NameOfUnit::same : NameOfUnit::another;
  // "F_m", the measured one, is not in metres
  const KnownChannel* known = known_channel(known_name(named.name));
  return named.is_clock || (known != nullptr && known->quantity == a.quantity) ? NameOfUnit::another : NameOfUnit::nothing;
}

// Names of columns may stand in angle brackets, and brackets around units: only what no table begins with.
bool is_markup(std::string_view text) {
  const std::string head = ascii_lower(trim(text.substr(0, 256)));
  return std::ranges::any_of(std::array{"<!doctype", "<!--", "<?xml", "<html", "<head", "<body", "<table", "<div", "<svg"}, [&](const char* begin) { return head.starts_with(begin); });
}

bool is_json(std::string_view text) {
  const std::string_view head = trim(text.substr(0, 256));
  if (head.empty() || (head.front() != '{' && head.front() != '[')) return false;
  const std::string_view next = trim(head.substr(1));
  return next.starts_with(head.front() == '{' ? "\"" : "{") || next.starts_with(head.front() == '{' ? "}" : "[");
}

}  // namespace

Result<void> CsvParser::check_kind(std::string_view chunk) const {
  const auto refuse = [&](const char* what, const char* hint) {
    return fail(ErrorCode::parse, std::string("the file is ") + what + ", not CSV", name_, hint);
  };
  if (chunk.starts_with("\x89HDF")) return refuse("HDF5", "give it the ending .h5");
  if (chunk.starts_with("MATLAB 5.0")) return refuse("a MATLAB file", "give it the ending .mat");
  if (chunk.starts_with("PK\x03\x04")) return refuse("a ZIP archive or spreadsheet", "export the sheet as CSV");
  if (chunk.starts_with("\xD0\xCF\x11\xE0")) return refuse("an Excel workbook", "export the sheet as CSV");
  if (chunk.starts_with("\x1F\x8B")) return refuse("packed by gzip", "unpack it");
  if (chunk.starts_with("TDSm")) return refuse("a TDMS file of LabVIEW", "export it as CSV");
  if (std::memchr(chunk.data(), 0, std::min<std::size_t>(chunk.size(), 4096)))
    return refuse("binary", "export it as CSV");
  constexpr const char* kTable = "give the recording itself: one line names the columns, for instance t_s,F_ref_N,U_V, and rows of numbers stand below it";
  if (chunk.starts_with("\xEF\xBB\xBF")) chunk.remove_prefix(3);
  if (is_markup(chunk)) return refuse("a page in HTML or XML", kTable);
  if (is_json(chunk)) return refuse("JSON", kTable);
  return {};
}

void CsvParser::skip_lines(const char*& p, const char* end, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) {
    const char* const stop = static_cast<const char*>(std::memchr(p, '\n', static_cast<std::size_t>(end - p)));
    const std::string_view line(p, static_cast<std::size_t>(stop - p));
    if (line.starts_with("Y_Unit_Label\t")) unit_labels_ = line;
    keep_above(line);
    p = stop + 1;
  }
  line_ += n;
}

void CsvParser::skip_preamble(const char*& p, const char* end) {
  const std::size_t above = lines_above_header({p, static_cast<std::size_t>(end - p)});
  if (above == 0) return;
  skip_lines(p, end, above);
  table_.notes.push_back("the names of the columns stand in line " + std::to_string(line_ + 1) + "; what is above was skipped");
}

Result<bool> CsvParser::take_labels(const char*& p, const char* end) {
  const auto found = labelled_lines({p, static_cast<std::size_t>(end - p)});
  if (!found) return false;
  skip_lines(p, end, found->above);
  FORCEGATE_CHECK_OK(header(join(found->labels, std::string(1, found->separator))));
  labels_ = found->labels;
  table_.notes.push_back("the names of the columns were read from the labels before the numbers" +
                         (found->above > 0 ? "; the " + (found->above > 1 ? std::to_string(found->above) + " lines" : std::string("line")) + " above them " +
                                                 (found->above > 1 ? "were" : "was") + " skipped"
                                           : ""));
  return true;
}

void CsvParser::keep_above(std::string_view line) {
  constexpr std::size_t kMostLines = 50, kMostBytes = 200;
  if (table_.above.size() < kMostLines) table_.above.emplace_back(line.substr(0, kMostBytes));
}

bool CsvParser::comment_names(std::string_view row) {
  const std::size_t begin = comment_.find_first_not_of("# ");
  if (begin == std::string::npos) return false;
  const std::string names = comment_.substr(begin);
  const char separator = choose_separator(names);
  cut_cells(row, separator, cells_);
  const std::size_t columns = cells_.size();
  if (columns < 2 || !is_row(cells_)) return false;
  cut_cells(names, separator, cells_);
  if (cells_.size() != columns || !std::ranges::all_of(cells_, is_word) || !header(names)) return false;
  table_.notes.push_back("the names of the columns were read from the comment above the first row");
  return true;
}

Result<void> CsvParser::header(std::string_view line) {
  separator_ = choose_separator(line);
  cut_cells(line, separator_, cells_);
  if (cells_.size() > kMostColumns)
    return error("the header has " + std::to_string(cells_.size()) + " columns", 1, "at most 4096 can be read");
  while (cells_.size() > 1 && trim(cells_.back()).empty()) cells_.pop_back(), ++trailing_;
  if (const std::size_t arrow = cells_[0].find(" -> "); arrow != std::string_view::npos && seconds_of_stamp(trim(cells_[0].substr(0, arrow))))
    return error("the lines begin with the stamps of a serial monitor, " + in_quotes(cells_[0].substr(0, arrow + 4)), 1,
                 "switch them off there, or replace \" -> \" by " + separator_in_words(separator_) + " in every line and name the column Time");
  if (std::ranges::none_of(cells_, is_word))
    return error("the first line holds numbers, not column names", 1,
                 "put a line like t_s,F_ref_N,U_V before the first row");
  for (const std::string_view cell : cells_) {
    CsvColumn column;
    column.header = header_text(cell);
    names_.push_back(column.header);
    table_.columns.push_back(std::move(column));
  }
  cut_cells(unit_labels_, '\t', cells_);  // LabVIEW's, above the header
  for (std::size_t c = 1; c < std::min(cells_.size(), table_.columns.size()); ++c)
    if (const std::string_view symbol = trim(cells_[c]); find_unit(symbol)) FORCEGATE_CHECK_OK(add_unit(table_.columns[c].header, symbol, 1));
  if (separator_ != ',') table_.notes.push_back(std::string("the separator is ") + separator_in_words(separator_));
  for (std::size_t a = 0; a < table_.columns.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      if (!table_.columns[a].header.empty() && table_.columns[a].header == table_.columns[b].header)
        return error("two columns are called " + in_quotes(table_.columns[a].header), 1, "rename or remove one of them");
  is_text_.assign(table_.columns.size(), 0);
  is_day_.assign(table_.columns.size(), 0);
  text_.resize(table_.columns.size());
  row_.resize(table_.columns.size());
  table_.header_line = line_;
  has_header_ = true;
  return {};
}

bool CsvParser::says_no_unit(std::string_view symbol) { return symbol.empty() || symbol == "-" || symbol == "1"; }

bool CsvParser::holds_units() const {
  constexpr std::size_t kLongest = 12;
  std::size_t units = 0;
  for (const std::string_view cell : cells_) {
    double value;
    const std::string symbol = unit_text(cell);
    if (says_no_unit(symbol)) continue;
    const bool known = find_unit(symbol).has_value();
    if (!known && !is_form_of_stamps(symbol) &&
        (symbol.size() > kLongest || read_cell(cell, '.', value) != CsvCell::text || read_cell(cell, ',', value) != CsvCell::text))
      return false;
    units += known;
  }
  return units > 0;
}

Result<void> CsvParser::add_unit(std::string& header, std::string_view symbol, std::size_t column) const {
  const NameOfUnit named = unit_in_name(header, symbol);
  if (named == NameOfUnit::another)
    return error("column " + in_quotes(header) + " has its unit in its name, and the line of units says " + in_quotes(symbol), column,
                 "mend the one that is wrong, or put - in the place of " + in_quotes(symbol) + " where the name is right");
  if (named == NameOfUnit::nothing) header += "_" + std::string(symbol);
  return {};
}

Result<bool> CsvParser::row_of_units(std::string_view line) {
  if (cells_.size() != row_.size() || !holds_units()) return false;
  std::vector<std::string> unknown;
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const std::string symbol = unit_text(cells_[c]);
    if (says_no_unit(symbol) || is_form_of_stamps(symbol)) continue;
    const bool known = find_unit(symbol).has_value();
    if (known) {
      FORCEGATE_CHECK_OK(add_unit(table_.columns[c].header, symbol, static_cast<std::size_t>(cells_[c].data() - line.data()) + 1));
      continue;
    }
    std::string& header = table_.columns[c].header;
    const std::string with_unit = header + " (" + printable_utf8(symbol) + ")";
    if (meaning_of(with_unit).unit.symbol.empty()) unknown.push_back(in_quotes(symbol) + " of column " + in_quotes(header));
    header = with_unit;
  }
  table_.notes.push_back("the second line was read as the units of the columns");
  if (!unknown.empty()) table_.notes.push_back("no unit known here: " + join(unknown, ", "));
  table_.skipped_lines.push_back(line_);
  return true;
}

bool CsvParser::row_of_oscilloscope() {
  const std::size_t n = names_.size();
  if (cells_.size() != n || n < 4 || names_[n - 2] != "Start" || names_[n - 1] != "Increment" || trim(cells_[0]) != "Sequence") return false;
  double start_s = 0.0, step_s = 0.0;
  if (read_cell(cells_[n - 2], '.', start_s) != CsvCell::number || read_cell(cells_[n - 1], '.', step_s) != CsvCell::number || !(step_s > 0.0)) return false;
  for (std::size_t c = 1; c + 2 < n; ++c)
    if (const auto unit = find_unit(trim(cells_[c]))) table_.columns[c].header += "_" + unit->symbol;
  scope_start_s_ = start_s;
  scope_step_s_ = step_s;
  table_.skipped_lines.push_back(line_);
  table_.notes.push_back("the second line was read as an oscilloscope's: units, and rows " + in_quotes(trim(cells_[n - 1])) +
                         " s apart from " + in_quotes(trim(cells_[n - 2])) + " s on");
  return true;
}

void CsvParser::time_by_increment() {
  table_.columns[0].header += "_s";
  for (double& t : table_.columns[0].value) t = scope_start_s_ + scope_step_s_ * t;
  table_.columns.resize(table_.columns.size() - 2);
  is_text_.resize(table_.columns.size());
}

bool CsvParser::is_header_again() {
  if (!seen_data_ || cells_.size() != row_.size()) return false;
  const bool names = std::ranges::equal(cells_, names_, [](std::string_view cell, const std::string& name) { return header_text(cell) == name; });
  const bool units = line_ == last_repeat_ + 1 && holds_units();
  if (!names && !units) return false;
  table_.skipped_lines.push_back(line_);
  if (!names) return true;
  if (repeats_++ == 0) first_repeat_ = line_;
  last_repeat_ = line_;
  return true;
}

void CsvParser::settle_point() {
  double value;
  for (std::size_t c = 0; c < cells_.size() && !point_settled_; ++c) {
    if (!has_decimal_comma(c)) continue;
    point_ = ',';
    point_settled_ = true;
    table_.notes.push_back("the decimals are commas");
  }
  // "10:31:07.25" and "31.05.2024" tell nothing of the other columns
  for (std::size_t c = 0; c < cells_.size() && !point_settled_; ++c)
    point_settled_ = !is_text_[c] && cells_[c].find('.') != std::string_view::npos && read_cell(cells_[c], '.', value) == CsvCell::number &&
                     !seconds_of_stamp(unquoted(cells_[c]));
}

bool CsvParser::has_decimal_comma(std::size_t column) const {
  if (is_text_[column]) return false;
  double value;
  const std::string_view cell = unquoted(cells_[column]);
  const std::size_t comma = cell.find(',');
  if (comma == std::string_view::npos || read_cell(cell, ',', value) != CsvCell::number) return false;
  if (cell.size() != comma + 4 || std::fabs(value) < 1.0) return true;
  // "1,234" may be a thousand: quoted beside commas that part the columns, or below a number that it follows as one ("999")
  constexpr double kThousand = 1000.0;
  const double above = seen_data_ ? table_.columns[column].value.back() : kMissing;
  return separator_ != ',' && !(std::fabs(kThousand * value - above) < std::fabs(value - above));
}

}  // namespace forcegate
