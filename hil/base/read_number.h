#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace forcegate {

/// The finite number that all of `text` is, independent of the locale; nullopt: it is none.
inline std::optional<double> read_number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace forcegate
