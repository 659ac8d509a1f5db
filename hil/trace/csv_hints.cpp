#include "hil/trace/csv_hints.h"

#include <algorithm>

#include "hil/base/text.h"
#include "hil/trace/csv_cells.h"

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

/// "11/20/2026 10:00:00": numbers of one or two digits, of which one is a month, and a year.
bool is_date_of_slashes(std::string_view cell) {
  std::size_t at = 0;
  const auto number = [&](std::size_t least, std::size_t most) {
    std::size_t digits = 0;
    while (at < cell.size() && is_digit(cell[at])) ++at, ++digits;
    return digits >= least && digits <= most;
  };
  const auto slash = [&] { return at < cell.size() && cell[at++] == '/'; };
  return number(1, 2) && slash() && number(1, 2) && slash() && number(2, 4) && (at == cell.size() || cell[at] == ' ' || cell[at] == ',' || cell[at] == 'T');
}

}  // namespace

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kMost = 40;
  return "\"" + readable(text, kMost) + (text.size() > kMost ? "...\"" : "\"");
}

std::string hint_for_cell(std::string_view cell, char point, bool is_settled) {
  cell = unquoted(cell);
  if (cell.find('\0') != std::string_view::npos) return "bytes of zero are no text: the file was cut or damaged there; take the line out, or export the file anew";
  if (cell.find("\xE2\x88\x92") != std::string_view::npos) return "its minus sign is the typographical one (U+2212): replace it by - throughout the file";
  if (is_date_of_slashes(cell))
    return std::string(kWhichIsTheMonth) + " is not told by " + printable_utf8(cell.substr(0, cell.find_first_of(" ,T"))) +
           ": write dates as 2024-05-31T10:31:07";
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

std::string hint_for_line(const std::vector<std::string_view>& cells, std::size_t columns, char separator, bool seen_data) {
  if (separator == ',' && cells.size() >= 2 * columns - 1 && columns > 1)
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
  return no_numbers ? "what is no row does not belong here: take the line out, or put # before it" : "every line needs one cell for each column" + missing;
}

}  // namespace forcegate
