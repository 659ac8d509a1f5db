#include "hil/trace/labelled_cells.h"

#include <algorithm>

#include "hil/base/text.h"
#include "hil/trace/csv_cells.h"

namespace forcegate {
namespace {

// "10" of "10:31" is no name.
bool is_label(std::string_view text) {
  return std::ranges::any_of(text, [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || static_cast<unsigned char>(c) >= 0x80; });
}

// Empty where a cell has none.
std::vector<std::string> labels_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  cut_cells(line, separator, cells);
  while (cells.size() > 1 && trim(cells.back()).empty()) cells.pop_back();
  std::vector<std::string> out;
  for (const std::string_view cell : cells) {
    double value;
    const std::size_t colon = cell.find(':');
    if (colon == std::string_view::npos || !is_label(cell.substr(0, colon)) || trim(cell.substr(colon + 1)).empty() ||
        read_cell(cell.substr(colon + 1), '.', value) == CsvCell::text)
      return {};
    out.emplace_back(trim(cell.substr(0, colon)));
  }
  return out;
}

}  // namespace

std::optional<LabelledLines> labelled_lines(std::string_view text) {
  constexpr std::size_t kMostAbove = 20, kLongestLine = 4096;
  LabelledLines out;
  for (std::size_t at = 0; at < kMostAbove + 2 && !text.empty(); ++at) {
    const std::size_t stop = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, stop);
    text.remove_prefix(std::min(stop + 1, text.size()));
    if (line.size() > kLongestLine) break;
    const char separator = choose_separator(trim(line));
    std::vector<std::string> labels = labels_of(line, separator);
    if (labels.size() > 1 && labels == out.labels && separator == out.separator) return out;
    out = {at, separator, labels.size() > 1 ? std::move(labels) : std::vector<std::string>{}};
  }
  return std::nullopt;
}

std::string_view behind_label(std::string_view cell, std::string_view label) {
  const std::size_t colon = cell.find(':');
  return colon != std::string_view::npos && trim(cell.substr(0, colon)) == label ? cell.substr(colon + 1) : cell;
}

}  // namespace forcegate
