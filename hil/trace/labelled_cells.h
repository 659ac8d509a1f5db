#pragma once
// Lines in which every cell tells its name, "Force:29.5<tab>ADC:38", as a board prints them for the serial plotter of the Arduino IDE.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace forcegate {

struct LabelledLines {
  std::size_t above = 0;  ///< lines before them: what a board says when it starts, or the end of a line that was half sent
  char separator = '\t';
  std::vector<std::string> labels;
};

/// Two of the first lines, one below the other, with the same two labels or more and a number behind each; nothing for any other text.
std::optional<LabelledLines> labelled_lines(std::string_view text);

/// What stands behind "LABEL:"; the cell itself where it has another label.
std::string_view behind_label(std::string_view cell, std::string_view label);

}  // namespace forcegate
