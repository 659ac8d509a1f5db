#include "hil/trace/csv_parser.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "hil/base/text.h"
#include "hil/trace/csv_cells.h"
#include "hil/trace/csv_hints.h"
#include "hil/trace/csv_preamble.h"
#include "hil/trace/date_time.h"
#include "hil/trace/decimal.h"
#include "hil/trace/labelled_cells.h"

namespace forcegate {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

inline const char* CsvParser::fast_row(const char* p) {
  const std::size_t n = row_.size();
  const char* const begin = p;
  if (trailing_ > 0 || point_ == separator_) return nullptr;
  for (std::size_t c = 0; c < n; ++c) {
    if (is_text_[c]) return nullptr;
    while (*p == ' ') ++p;
    p = read_plain_decimal(p, point_, row_[c]);
    if (!p) return nullptr;
    if (c + 1 == n) break;
    if (*p != separator_) return nullptr;
    ++p;
  }
  if (*p == '\r') ++p;
  if (*p != '\n') return nullptr;
  if (!point_settled_) point_settled_ = std::memchr(begin, '.', static_cast<std::size_t>(p - begin)) != nullptr;
  for (std::size_t c = 0; c < n; ++c) table_.columns[c].value.push_back(row_[c]);
  return p + 1;
}

Result<void> CsvParser::lines(const char* p, const char* end, bool cut) {
  while (p < end) {
    ++line_;
    if (has_header_ && seen_data_) {
      if (const char* next = fast_row(p)) {
        p = next;
        continue;
      }
    }
    const char* const stop = static_cast<const char*>(std::memchr(p, '\n', static_cast<std::size_t>(end - p)));
    std::string_view line(p, static_cast<std::size_t>(stop - p));
    p = stop + 1;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    const std::string_view bare = trim(line);
    if (bare.empty() || bare.front() == '#') {
      if (has_header_) table_.skipped_lines.push_back(line_);
      else if (!bare.empty()) keep_above(comment_ = bare);
      continue;
    }
    if (!has_header_) {
      if (!comment_names(line)) {
        FORCEGATE_CHECK_OK(header(line));
        continue;
      }
      table_.header_line = line_ - 1;
    }
    if (words_below_names_ > 0) {
      --words_below_names_;
      table_.skipped_lines.push_back(line_);
      table_.notes.push_back("line " + std::to_string(line_) + " holds words between the names and their units, and was skipped");
      continue;
    }
    FORCEGATE_CHECK_OK(slow_row(line, cut));
  }
  return {};
}

Result<void> CsvParser::feed(std::string_view chunk, bool last_line_is_cut) {
  const char* p = chunk.data();
  const char* const end = p + chunk.size();
  if (!started_) {
    started_ = true;
    FORCEGATE_CHECK_OK(check_kind(chunk));
    if (chunk.starts_with("\xEF\xBB\xBF")) p += 3;
    FORCEGATE_TRY(const bool labelled, take_labels(p, end));
    if (!labelled) {
      skip_preamble(p, end);
      words_below_names_ = lines_of_words_below_names({p, static_cast<std::size_t>(end - p)});
    }
  }
  if (!last_line_is_cut) return lines(p, end, false);
  const void* const before = p < end - 1 ? ::memrchr(p, '\n', static_cast<std::size_t>(end - 1 - p)) : nullptr;
  const char* const last = before != nullptr ? static_cast<const char*>(before) + 1 : p;
  FORCEGATE_CHECK_OK(lines(p, last, false));
  const std::size_t rows = table_.rows();
  FORCEGATE_CHECK_OK(lines(last, end, true));
  if (table_.rows() > rows) drop_cut_row({last, static_cast<std::size_t>(end - last - 1)});
  return {};
}

void CsvParser::expect(std::size_t bytes_in_all, std::size_t bytes_so_far) {
  if (table_.rows() == 0 || bytes_so_far == 0) return;
  const double rows = static_cast<double>(table_.rows()) * static_cast<double>(bytes_in_all) /
                      static_cast<double>(bytes_so_far);
  for (CsvColumn& c : table_.columns) c.value.reserve(static_cast<std::size_t>(rows * 1.01) + 64);
}

Result<CsvTable> CsvParser::finish() {
  if (!has_header_)
    return fail(ErrorCode::parse, "the file is empty: not even a header line", name_,
                "the first line must name the columns, for instance t_s,F_ref_N,U_V");
  if (repeats_ > 0)
    table_.notes.push_back("the names of the columns stand again in line " + std::to_string(first_repeat_) +
                           (repeats_ > 1 ? " and " + std::to_string(repeats_ - 1) + " more" : "") + ", as where a logger was started anew; skipped");
  for (std::size_t c = 0; c < is_text_.size(); ++c)
    if (is_text_[c]) {
      if (is_day_[c]) text_[c].day_s = std::move(table_.columns[c].value);
      if (text_[c].word_of_row.size() > table_.rows()) text_[c].word_of_row.resize(table_.rows());  // of a line that was dropped
      table_.text_columns.push_back(std::move(text_[c]));
    }
  constexpr double kMostShort = 0.02;  // of the rows
  if (static_cast<double>(short_rows_) > kMostShort * static_cast<double>(table_.rows())) return Unexpected(std::move(first_short_row_));
  if (short_rows_ > 0)
    table_.notes.push_back(std::to_string(short_rows_) + (short_rows_ > 1 ? " lines lack" : " line lacks") + " a cell between blanks, which one nobody can tell: left out (" +
                           (short_rows_ > 1 ? "the first is line " : "line ") + std::to_string(first_short_line_) + ")");
  if (scope_step_s_ > 0.0) time_by_increment();
  std::size_t at = 0;
  std::erase_if(table_.columns, [&](const CsvColumn&) { return is_text_[at++] != 0; });
  if (table_.rows() == 0)
    return fail(ErrorCode::parse, "the file has a header but no rows of numbers", name_,
                "check that the recording was not empty");
  return std::move(table_);
}

Unexpected CsvParser::error(std::string text, std::size_t column, std::string hint) const {
  return fail(ErrorCode::parse, std::move(text),
              name_ + ":" + std::to_string(line_) + ":" + std::to_string(column), std::move(hint));
}

void CsvParser::cut(std::string_view line) {
  cut_cells(line, separator_, cells_);
  for (std::size_t c = 0; c < std::min(cells_.size(), labels_.size()); ++c) cells_[c] = behind_label(cells_[c], labels_[c]);
}

Result<void> CsvParser::slow_row(std::string_view line, bool cut_short) {
  cut(line);
  for (std::size_t k = 0; k < trailing_ && cells_.size() > row_.size() && trim(cells_.back()).empty(); ++k)
    cells_.pop_back();
  if (cells_.size() == row_.size() + 1 && trim(cells_.back()).empty()) cells_.pop_back();
  if (cells_.size() + 1 == row_.size() && ascii_lower(names_.back()) == kMayBeShort) cells_.push_back(line.substr(line.size()));
  if (!seen_data_) {
    FORCEGATE_TRY(const bool units, row_of_units(line));
    if (units || row_of_oscilloscope()) return {};
  }
  if (is_header_again()) return {};
  if (cells_.size() != row_.size()) {
    if (cut_short && cells_.size() < row_.size()) {
      table_.notes.push_back("the last line is cut short and was dropped");
      return {};
    }
    const Unexpected ragged = error("the line has " + std::to_string(cells_.size()) + (cells_.size() == 1 ? " cell" : " cells") +
                                        ", the header has " + std::to_string(row_.size()) + " columns",
                                    line.size() + 1, hint_for_line(line, cells_, row_.size(), separator_, seen_data_));
    // between blanks nobody can tell which cell is missing: the row is, where few are
    if (separator_ != ' ' || !seen_data_ || cells_.size() > row_.size() || !is_row(cells_)) return ragged;
    if (short_rows_++ == 0) first_short_row_ = ragged.value(), first_short_line_ = line_;
    table_.skipped_lines.push_back(line_);
    return {};
  }
  if (!point_settled_) settle_point();
  bool all_text = true;
  for (std::size_t c = 0; c < row_.size(); ++c) {
    const CsvCell kind = read_cell(cells_[c], point_, row_[c]);
    const auto position = static_cast<std::size_t>(cells_[c].data() - line.data()) + 1;
    all_text = all_text && kind == CsvCell::text;
    if (is_day_[c]) read_day(c, kind);
    if (is_text_[c]) read_word(c, kind);
    if (kind == CsvCell::number && seen_data_ && !cut_short) FORCEGATE_CHECK_OK(check_zone(c, position));
    if (kind == CsvCell::number || is_text_[c]) continue;
    if (kind == CsvCell::text && cut_short && c + 1 == row_.size()) {
      table_.notes.push_back("the last line is cut short and was dropped");
      return {};
    }
    if (kind == CsvCell::text && table_.columns[c].missing == table_.rows()) {  // nothing stood in it so far
      is_text_[c] = 1;
      text_[c] = {table_.columns[c].header, readable(unquoted(cells_[c]), 40), hint_for_cell(cells_[c], point_, point_settled_), line_, position, {}, {}, {}};
      is_day_[c] = table_.rows() == 0;  // a remark may be a date too
      read_day(c, kind);
      if (table_.rows() > 0) text_[c].words = {""}, text_[c].word_of_row.assign(table_.rows(), 0);
      read_word(c, kind);
      continue;
    }
    if (kind == CsvCell::text)
      return error(in_quotes(unquoted(cells_[c])) + " in column " + in_quotes(table_.columns[c].header) + " is not a number", position,
                   seen_data_ && is_word(cells_[0]) && std::ranges::count_if(cells_, is_word) >= std::min<std::ptrdiff_t>(2, std::ssize(cells_)) ? kNoRow : hint_for_cell(cells_[c], point_, point_settled_));
    ++table_.columns[c].missing;
  }
  if (all_text && !seen_data_)
    return error("no cell of the first line below the names is a number: " + in_quotes(trim(line)), 1,
                 hint_for_cell(cells_[0], point_, point_settled_).starts_with("leave")
                     ? "one line must name the columns, and rows of numbers stand below it"
                     : hint_for_cell(cells_[0], point_, point_settled_));
  if (!seen_data_)
    for (std::size_t c = 0; c < row_.size(); ++c) {
      table_.columns[c].dates = seconds_of_stamp(unquoted(cells_[c])).has_value();
      table_.columns[c].zoned = table_.columns[c].dates && has_zone(cells_[c]);
    }
  seen_data_ = true;
  for (std::size_t c = 0; c < row_.size(); ++c) table_.columns[c].value.push_back(row_[c]);
  return {};
}

Result<void> CsvParser::check_zone(std::size_t c, std::size_t position) const {
  const CsvColumn& column = table_.columns[c];
  if (!column.dates || has_zone(cells_[c]) == column.zoned) return {};
  return error(in_quotes(unquoted(cells_[c])) + " in column " + in_quotes(column.header) + (column.zoned ? " has no zone, and the stamps above it have one" : " has a zone, and the stamps above it have none"),
               position, "write all of them with their zone, as 2024-05-31T10:31:07Z, or none");
}

void CsvParser::read_day(std::size_t c, CsvCell kind) {
  const auto day_s = is_day_[c] && kind == CsvCell::text ? seconds_of_date(unquoted(cells_[c])) : std::nullopt;
  row_[c] = day_s.value_or(kNan);
  is_day_[c] = is_day_[c] && (day_s || kind == CsvCell::missing);
}

void CsvParser::read_word(std::size_t c, CsvCell kind) {
  constexpr std::size_t kLongest = 40;
  TextColumn& column = text_[c];
  if (column.word_of_row.size() != table_.rows()) return;  // there were too many
  const std::string word = kind == CsvCell::missing ? std::string() : readable(unquoted(cells_[c]), kLongest);
  const auto at = std::ranges::find(column.words, word);
  if (at == column.words.end() && column.words.size() == kMostWords) {
    column.words.clear();
    column.word_of_row.clear();
    return;
  }
  column.word_of_row.push_back(static_cast<std::uint8_t>(at - column.words.begin()));
  if (at == column.words.end()) column.words.push_back(word);
}

void CsvParser::drop_cut_row(std::string_view line) {
  cut(line);
  const std::size_t c = row_.size() - 1, rows = table_.rows();
  if (cells_.size() <= c || is_text_[c] || rows < 2) return;
  std::vector<double>& values = table_.columns[c].value;
  const std::string_view text = trim(cells_[c]);
  const double above = values[rows - 2], last = values.back();
  const bool whole = text.empty() ? std::isnan(above) : text.back() != point_ && text.back() != '-' && text.back() != '+';
  constexpr std::size_t kFewestRows = 16;
  double largest = rows >= kFewestRows ? 0.0 : HUGE_VAL;
  for (std::size_t i = 1; i + 1 < rows; ++i)
    if (const double step = std::fabs(values[i] - values[i - 1]); step > largest) largest = step;
  if (whole && !(std::fabs(last - above) > largest)) return;
  table_.notes.push_back("the file ends in " + (text.empty() ? "an empty cell" : in_quotes(text)) + " without a line end: the last line is cut short and was dropped");
  for (CsvColumn& column : table_.columns) {
    column.missing -= std::isnan(column.value.back()) && column.missing > 0;
    column.value.pop_back();
  }
}

}  // namespace forcegate
