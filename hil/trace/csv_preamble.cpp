#include "hil/trace/csv_preamble.h"

#include <algorithm>
#include <span>
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
    std::string_view line = text.substr(0, stop);
    text.remove_prefix(std::min(stop + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.size() > kLongestLine) break;
    if (const std::string_view bare = trim(line); !bare.empty() && bare.front() != '#') out.push_back({line, above});  // a tab may begin it
  }
  return out;
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  cut_cells(line, separator, cells);
  while (cells.size() > 1 && trim(cells.back()).empty()) cells.pop_back();
  return cells;
}

bool are_names(const std::vector<std::string_view>& cells) { return cells.size() > 1 && std::ranges::all_of(cells, is_word); }

// A comment at the end is not looked at.
bool are_numbers(std::string_view line, char separator, const std::vector<std::string_view>& names) {
  std::vector<std::string_view> cells;
  cut_cells(line, separator, cells);
  const std::size_t columns = names.size() - (ascii_lower(trim(names.back())) == kMayBeShort ? 1 : 0);
  if (cells.size() < columns || cells_of(line, separator).size() > names.size()) return false;
  if (columns < names.size()) cells.resize(columns);
  return is_row(cells);
}

bool are_units(std::string_view line, char separator, std::size_t columns) {
  std::vector<std::string_view> cells;
  cut_cells(line, separator, cells);
  while (cells.size() > columns && trim(cells.back()).empty()) cells.pop_back();  // the last column may have no unit
  return cells.size() == columns && std::ranges::all_of(cells, [](std::string_view cell) {
           const std::string symbol = unit_text(cell);
           return symbol.empty() || symbol == "-" || symbol == "1" || find_unit(symbol) || is_form_of_stamps(symbol);
         });
}

bool holds_two_numbers(std::string_view line, char separator) { return std::ranges::count_if(cells_of(line, separator), is_number) > 1; }

bool holds_unit(const std::vector<std::string_view>& cells) {
  return std::ranges::any_of(cells, [](std::string_view cell) { return find_unit(unit_text(cell)).has_value(); });
}

// Its lines of origins and steps (X0, Delta_X) are a word and as many numbers, as rows below X_Dimension would be.
std::size_t below_labview_head(const std::vector<Line>& lines) {
  std::size_t out = 0;
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (trim(lines[i].text).starts_with("***End_of_Header***")) out = i + 1;
  return out;
}

}  // namespace

std::size_t lines_above_header(std::string_view text) {
  if (lines_of_words_below_names(text) > 0) return 0;  // the units that end them are no names
  const std::vector<Line> lines = first_lines(text);
  for (std::size_t i = below_labview_head(lines); i + 2 < lines.size(); ++i) {
    const char separator = choose_separator(lines[i].text);
    const std::vector<std::string_view> names = cells_of(lines[i].text, separator);
    if (!are_names(names)) continue;
    const std::size_t data = are_units(lines[i + 1].text, separator, names.size()) ? i + 2 : i + 1;
    if (data + 1 >= lines.size() || !are_numbers(lines[data].text, separator, names) || !are_numbers(lines[data + 1].text, separator, names)) continue;
    const auto above = std::span(lines).first(i);
    const bool told_apart = i > 0 && cells_of(lines[i - 1].text, separator).size() != names.size();
    const bool all_titles = i > 0 && !holds_unit(names) && std::ranges::none_of(above, [&](const Line& line) { return holds_two_numbers(line.text, separator); });
    return told_apart || all_titles ? lines[i].above : 0;
  }
  return 0;
}

std::size_t lines_of_words_below_names(std::string_view text) {
  constexpr std::size_t kMost = 3;
  const std::vector<Line> lines = first_lines(text);
  if (lines.empty()) return 0;
  const char separator = choose_separator(lines[0].text);
  const std::vector<std::string_view> names = cells_of(lines[0].text, separator);
  if (!are_names(names)) return 0;
  for (std::size_t i = 1; i + 1 < lines.size() && i <= kMost + 1; ++i) {
    const std::vector<std::string_view> cells = cells_of(lines[i].text, separator);
    if (are_units(lines[i].text, separator, names.size()) && holds_unit(cells)) return are_numbers(lines[i + 1].text, separator, names) ? i - 1 : 0;
    if (cells.size() > names.size() || std::ranges::any_of(cells, is_number)) return 0;
  }
  return 0;
}

}  // namespace forcegate
