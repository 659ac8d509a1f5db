#pragma once
// Numbers in the words of a control line. A word is a number as a whole or not at all.

#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

namespace forcegate::emulated {

template <class T>
std::optional<T> parsed_word(std::string_view word) {
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Finite.
inline std::optional<double> number_in(std::string_view word) {
  const auto value = parsed_word<double>(word);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// From 0 on, without sign.
inline std::optional<std::uint64_t> whole_in(std::string_view word) { return parsed_word<std::uint64_t>(word); }

}  // namespace forcegate::emulated
