#pragma once
// Whole numbers in the words of a control line. A word is a number as a whole or not at all; others: hil/base/read_number.h.

#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>

namespace forcegate::emulated {

/// From 0 on, without sign.
inline std::optional<std::uint64_t> whole_in(std::string_view word) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace forcegate::emulated
