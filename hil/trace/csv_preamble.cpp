#include "hil/trace/csv_preamble.h"

#include <algorithm>
#include <vector>

#include "hil/base/text.h"
#include "hil/base/units.h"
#include "hil/trace/csv_cells.h"

namespace forcegate {
namespace {

constexpr std::size_t kMostLines = 200, kLongestLine = 65536;

struct Line {
  std::string_view text;
  std::size_t above = 0;  ///< physical lines before it
};

std::vector<Line> first_lines(std::string_view text) {
  std::vector<Line> out;
  for (std::size_t above = 0; !text.empty() && out.size() < kMostLines; ++above) {
    const std::size_t stop = std::min(text.find('\n'), text.size());
    const std::string_view line = trim(text.substr(0, stop));
    text.remove_prefix(std::min(stop + 1, text.size()));
    if (line.size() > kLongestLine) break;
    if (!line.empty() && line.front() != '#') out.push_back({line, above});
  }
  return out;
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  cut_cells(line, separator, cells);
  while (cells.size() > 1 && trim(cells.back()).empty()) cells.pop_back();
  return cells;
}

bool are_names(const std::vector<std::string_view>& cells) {
  return cells.size() > 1 && std::ranges::all_of(cells, [](std::string_view cell) {
           double value;
           return read_cell(cell, '.', value) == CsvCell::text && read_cell(cell, ',', value) == CsvCell::text;
         });
}

// Two numbers at least, and nothing that is none.
bool are_numbers(std::string_view line, char separator, std::size_t columns) {
  std::vector<std::string_view> cells;
  cut_cells(line, separator, cells);
  if (cells.size() < columns || cells_of(line, separator).size() > columns) return false;
  return std::ranges::any_of(std::string_view(".,"), [&](char point) {
    std::size_t numbers = 0;
    for (const std::string_view cell : cells) {
      double value;
      const CsvCell kind = read_cell(cell, point, value);
      if (kind == CsvCell::text) return false;
      numbers += kind == CsvCell::number;
    }
    return numbers > 1;
  });
}

bool are_units(std::string_view line, char separator, std::size_t columns) {
  const std::vector<std::string_view> cells = cells_of(line, separator);
  return cells.size() == columns && std::ranges::all_of(cells, [](std::string_view cell) {
           const std::string_view symbol = strip_brackets(trim(cell));
           return symbol.empty() || symbol == "-" || symbol == "1" || find_unit(symbol);
         });
}

}  // namespace

std::size_t lines_above_header(std::string_view text) {
  const std::vector<Line> lines = first_lines(text);
  for (std::size_t i = 0; i + 2 < lines.size(); ++i) {
    const char separator = choose_separator(lines[i].text);
    const std::vector<std::string_view> names = cells_of(lines[i].text, separator);
    if (!are_names(names)) continue;
    const std::size_t data = are_units(lines[i + 1].text, separator, names.size()) ? i + 2 : i + 1;
    if (data + 1 >= lines.size() || !are_numbers(lines[data].text, separator, names.size()) ||
        !are_numbers(lines[data + 1].text, separator, names.size()))
      continue;
    const bool told_apart = i > 0 && cells_of(lines[i - 1].text, separator).size() != names.size();
    return told_apart ? lines[i].above : 0;
  }
  return 0;
}

}  // namespace forcegate
