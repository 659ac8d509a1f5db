#include "hil/trace/csv_cells.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include "hil/base/text.h"
#include "hil/base/units.h"
#include "hil/trace/date_time.h"

namespace forcegate {
namespace {

constexpr std::size_t kLongestHeader = 200;
constexpr std::string_view kReplaced = "\xEF\xBF\xBD";

// "x,mm": of every cell that has a comma.
bool commas_part_units(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  cut_cells(line, separator, cells);
  return std::ranges::all_of(cells, [](std::string_view cell) {
    const std::size_t comma = cell.find(',');
    return comma == std::string_view::npos || find_unit(trim(cell.substr(comma + 1))).has_value();
  });
}

}  // namespace

std::string_view unquoted(std::string_view text) {
  text = trim(text);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = trim(text.substr(1, text.size() - 2));
  return text;
}

CsvCell read_cell(std::string_view text, char point, double& out) {
  text = unquoted(text);
  out = std::numeric_limits<double>::quiet_NaN();
  if (text.empty()) return CsvCell::missing;
  std::string plain(text.front() == '+' ? text.substr(1) : text);
  // beside decimal commas a point parts the thousands, or the file holds both: "1.007" is 1007 to one program and 1.007 to another
  const bool reads_two_ways = point != '.' && text.find('.') != std::string_view::npos;
  if (point != '.') std::replace(plain.begin(), plain.end(), point, '.');
  double value = 0.0;
  const auto [stop, error] = std::from_chars(plain.data(), plain.data() + plain.size(), value);
  const char* const end = reads_two_ways ? plain.data() : stop;
  if (end == plain.data() + plain.size() && error == std::errc()) {
    if (!std::isfinite(value)) return CsvCell::missing;
    out = value;
    return CsvCell::number;
  }
  if (end == plain.data() + plain.size() && error == std::errc::result_out_of_range) return CsvCell::missing;
  const std::string word = ascii_lower(text);
  for (const char* missing : {"na", "n/a", "null", "none", "nan", "-nan", "-", "--", "#n/a", "\xE2\x88\x9E", "-\xE2\x88\x9E"})
    if (word == missing) return CsvCell::missing;
  if (const auto stamp_s = seconds_of_stamp(text)) {
    out = *stamp_s;
    return CsvCell::number;
  }
  return CsvCell::text;
}

bool is_number(std::string_view cell) {
  double value;
  return read_cell(cell, '.', value) == CsvCell::number || read_cell(cell, ',', value) == CsvCell::number;
}

bool is_word(std::string_view cell) {
  double value;
  return read_cell(cell, '.', value) == CsvCell::text && read_cell(cell, ',', value) == CsvCell::text;
}

bool is_row(const std::vector<std::string_view>& cells) {
  const auto numbers = std::ranges::count_if(cells, is_number), words = std::ranges::count_if(cells, is_word);
  return numbers > 1 && 2 * words <= numbers;
}

char choose_separator(std::string_view line) {
  std::size_t count[4] = {};
  constexpr char kCandidates[] = {',', ';', '\t', '|'};
  bool inside = false;
  for (const char c : line) {
    if (c == '"') inside = !inside;
    for (std::size_t k = 0; k < 4 && !inside; ++k) count[k] += c == kCandidates[k];
  }
  const auto best = static_cast<std::size_t>(std::max_element(count, count + 4) - count);
  for (std::size_t k = 1; k < 4 && best == 0; ++k)
    if (count[k] > 0 && commas_part_units(line, kCandidates[k])) return kCandidates[k];
  if (count[best] > 0) return kCandidates[best];
  return trim(line).find(' ') != std::string_view::npos && line.find('"') == std::string_view::npos ? ' ' : ',';
}

void cut_cells(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  if (separator == ' ') line = trim(line);
  std::size_t start = 0;
  bool inside = false;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') inside = !inside;
    if (i < line.size() && (inside || line[i] != separator)) continue;
    if (separator == ' ' && i == start) {
      ++start;
      continue;
    }
    cells.push_back(line.substr(start, i - start));
    start = i + 1;
  }
}

std::string header_text(std::string_view cell) { return readable(unquoted(cell), kLongestHeader); }

std::string readable(std::string_view text, std::size_t most) {
  if (text.size() > most) {
    while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xC0) == 0x80) --most;  // no half of a letter
    text = text.substr(0, most);
  }
  std::string shown = printable_utf8(text);
  if (shown.find(kReplaced) == std::string::npos) return shown;
  std::string recoded;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0xA0) {
      recoded += static_cast<char>(0xC0 | (byte >> 6));
      recoded += static_cast<char>(0x80 | (byte & 0x3F));
    } else {
      recoded += c;
    }
  }
  recoded = printable_utf8(recoded);
  return recoded.find(kReplaced) == std::string::npos ? recoded : shown;
}

std::string unit_text(std::string_view cell) {
  std::string_view symbol = unquoted(cell);
  if (symbol.size() > 2 && (symbol.front() == '[' || symbol.front() == '(')) symbol = trim(symbol.substr(1, symbol.size() - 2));
  if (symbol.starts_with("in ")) symbol = trim(symbol.substr(3));
  return header_text(symbol);
}

bool is_form_of_stamps(std::string_view symbol) {
  constexpr std::size_t kLongest = 32;
  const std::string lower = ascii_lower(symbol);
  return lower.size() <= kLongest && lower.find("mm") != std::string::npos && lower.find_first_of(":.-/") != std::string::npos &&
         lower.find_first_not_of("hmsfdytja0: .,-/") == std::string::npos;
}

}  // namespace forcegate
