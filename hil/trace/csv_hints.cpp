#include "hil/trace/csv_hints.h"

#include <algorithm>
#include <optional>

#include "hil/base/text.h"
#include "hil/trace/csv_cells.h"
#include "hil/trace/date_time.h"

namespace forcegate {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// "1,000.64" without what parts the thousands (a comma, an apostrophe, a blank, or a point beside decimal commas); "" for everything else.
std::string without_thousands(std::string_view cell, char point) {
  std::string plain;
  std::size_t group = 0, groups = 0;
  bool decimals = false, only_blanks = true;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    const std::string_view rest = cell.substr(i);
    const std::size_t blank = rest.starts_with("\xC2\xA0") ? 2 : rest.starts_with("\xE2\x80\xAF") ? 3 : rest[0] == '\xA0' || rest[0] == ' ' ? 1 : 0;
    if (is_digit(rest[0])) {
      ++group;
    } else if (rest[0] == point && !decimals) {
      if (groups > 0 && group != 3) return {};
      decimals = true;
    } else if (!decimals && group > 0 && (groups == 0 ? group <= 3 : group == 3) && (blank > 0 || rest[0] == ',' || rest[0] == '.' || rest[0] == '\'')) {
      ++groups;
      group = 0;
      only_blanks = only_blanks && blank > 0;
      i += blank > 0 ? blank - 1 : 0;
      continue;
    } else if (i > 0 || (rest[0] != '-' && rest[0] != '+')) {
      return {};
    }
    plain += rest[0];
  }
  if (groups == 0 || (!decimals && group != 3)) return {};
  const std::size_t digit = plain.find_first_of("0123456789"), first = plain.find_first_not_of('0', digit);
  if (first == digit) return plain;
  // "0.000" has decimals of another kind, "0 598,79" is written so to keep its width
  if (!only_blanks) return {};
  const std::size_t units = std::min(plain.find(point), plain.size()) - 1;
  return plain.erase(digit, std::min(first, units) - digit);
}

struct DateOfSlashes {
  int first = 0, second = 0, year = 0;
};

/// "11/20/2026 10:00:00": numbers of one or two digits, of which one is a month, and a year.
std::optional<DateOfSlashes> date_of_slashes(std::string_view cell) {
  DateOfSlashes date;
  std::size_t at = 0;
  const auto number = [&](std::size_t least, std::size_t most, int& value) {
    std::size_t digits = 0;
    for (; at < cell.size() && is_digit(cell[at]) && digits <= most; ++at, ++digits) value = 10 * value + (cell[at] - '0');
    return digits >= least && digits <= most;
  };
  const auto slash = [&] { return at < cell.size() && cell[at++] == '/'; };
  const bool whole = number(1, 2, date.first) && slash() && number(1, 2, date.second) && slash() && number(2, 4, date.year) &&
                     (at == cell.size() || cell[at] == ' ' || cell[at] == ',' || cell[at] == 'T');
  return whole ? std::optional(date) : std::nullopt;
}

// A date of one day only does not tell how the others of its column are meant, so that none is read.
std::string hint_for_date_of_slashes(const DateOfSlashes& date, std::string_view written) {
  constexpr int kMonths = 12;
  const bool month_first = date.first <= kMonths && date.second > kMonths, day_first = date.first > kMonths && date.second <= kMonths;
  const std::string which(kWhichIsTheMonth), day = printable_utf8(written);
  if (date.year < 1000 || (!month_first && !day_first)) return which + " is not told by " + day + ": write dates as 2024-05-31T10:31:07";
  const int month = month_first ? date.first : date.second, of_month = month_first ? date.second : date.first;
  const auto two = [](int n) { return (n < 10 ? "0" : "") + std::to_string(n); };
  return which + " is told by " + day + ", the " + (month_first ? "first" : "second") + ", but not by every date of this form: write dates as 2024-05-31T10:31:07, this one as " +
         std::to_string(date.year) + "-" + two(month) + "-" + two(of_month);
}

/// "24:00:00.000", "2025-02-31 12:00:00": the form of a stamp, whatever its numbers.
bool has_form_of_stamp(std::string_view cell) {
  if (cell.empty() || !is_digit(cell[0]) || cell.find_first_not_of("0123456789:.,-/+TZ APMapm") != std::string_view::npos) return false;
  const auto parts = std::ranges::count(cell, ':') + std::ranges::count(cell, '-');
  return parts >= 2 && cell.find(':') != std::string_view::npos;
}

/// The separator that parts the line into rows of numbers, as the other lines are not; 0 where there is none.
char other_separator(std::string_view line, std::size_t columns, char separator) {
  for (const char other : {',', ';', '\t', '|', ' '}) {
    std::vector<std::string_view> cells;
    if (other != separator) cut_cells(line, other, cells);
    if (columns > 1 && cells.size() == columns && is_row(cells)) return other;
  }
  return 0;
}

}  // namespace

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kMost = 40;
  return "\"" + readable(text, kMost) + (text.size() > kMost ? "...\"" : "\"");
}

std::string hint_for_cell(std::string_view cell, char point, bool is_settled) {
  cell = unquoted(cell);
  if (cell.find('\0') != std::string_view::npos) return "bytes of zero are no text: the file was cut or damaged there; take the line out, or export the file anew";
  if (cell.find("\xE2\x88\x92") != std::string_view::npos) return std::string(kTypographicMinus) + " (U+2212): replace it by - throughout the file";
  if (const auto date = date_of_slashes(cell)) return hint_for_date_of_slashes(*date, cell.substr(0, cell.find_first_of(" ,T")));
  if (has_form_of_stamp(cell) && !seconds_of_stamp(cell))
    return std::string(kNoSuchTime) + ": hours end at 23, minutes at 59, seconds at 60 and days with their month; midnight is 00:00:00 of the next day";
  double value;
  const char other = point == '.' ? ',' : '.';
  if (const std::string plain = without_thousands(cell, point); !plain.empty()) {
    const bool two_ways = std::ranges::count(cell, other) == 1 && cell.find(point) == std::string_view::npos && cell.find(other) != std::string_view::npos;
    return "write " + plain + " and not " + printable_utf8(cell.substr(0, 40)) + ": nothing may part the thousands" +
           (!two_ways      ? ""
            : !is_settled  ? ", and where it is no thousand, the decimals need a point"
            : point == '.' ? ", and the decimals of this file are points"
                           : ", and the decimals of this file are commas");
  }
  if (read_cell(cell, other, value) == CsvCell::number)
    return std::string("the decimals of this file are ") + (point == '.' ? "points; write 1.5 and not 1,5" : "commas; write 1,5 and not 1.5");
  const std::size_t number = cell.find_first_not_of("+-.,0123456789");
  if (number != std::string_view::npos && number > 0 && is_digit(cell[number - 1]) &&
      read_cell(cell.substr(0, number), point, value) == CsvCell::number && cell.size() < number + 8 &&
      cell.find_first_of("/:0123456789", number) == std::string_view::npos)
    return "write the number alone; a unit belongs behind the name of the column, as in F_ref_N";
  return "leave the cell empty when the value is missing";
}

std::string separator_in_words(char separator) {
  return separator == ';' ? "a semicolon" : separator == '\t' ? "a tab" : separator == '|' ? "a bar" : separator == ' ' ? "a blank" : "a comma";
}

std::string hint_for_line(std::string_view line, const std::vector<std::string_view>& cells, std::size_t columns, char separator, bool seen_data) {
  if (const char other = other_separator(line, columns, separator); other != 0)
    return "its cells are parted by " + separator_in_words(other) + ", those above it by " + separator_in_words(separator) + ": write one separator throughout the file" +
           (seen_data ? ", or the rows from here on into a file of their own" : "");
  const bool has_points = std::ranges::any_of(cells, [](std::string_view cell) { return cell.find('.') != std::string_view::npos; });
  if (separator == ',' && cells.size() >= 2 * columns - 1 && columns > 1 && !has_points)
    return "these look like decimal commas; write decimal points, or separate the columns by semicolons";
  // several blanks are one separator
  const std::string missing = separator == ' '
                                  ? "; blanks leave no cell empty: write nan for a missing value, or separate the columns by commas"
                                  : "; leave a missing value empty";
  if (!seen_data) return "the first line must name the columns: take out what stands above the line of names" + missing;
  const bool no_numbers = std::ranges::none_of(cells, [](std::string_view cell) {
    double value;
    return read_cell(cell, '.', value) == CsvCell::number;
  });
  return no_numbers ? kNoRow : "every line needs one cell for each column" + missing;
}

}  // namespace forcegate
