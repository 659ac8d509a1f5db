#pragma once
// Whether a word of a note is one of several.

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace forcegate {

template <std::size_t n>
bool is_one_of(const std::string& word, const std::array<std::string_view, n>& words) {
  return std::ranges::find(words, word) != words.end();
}

}  // namespace forcegate
