#pragma once

#include <cctype>
#include <string>
#include <string_view>

namespace forcegate {

/// A name as a file may have it: letters in lower case and digits, "_" for everything else.
inline std::string slug(std::string_view name) {
  std::string out;
  for (const char c : name) {
    const auto letter = static_cast<unsigned char>(c);
    out += std::isalnum(letter) != 0 ? static_cast<char>(std::tolower(letter)) : '_';
  }
  return out;
}

}  // namespace forcegate
