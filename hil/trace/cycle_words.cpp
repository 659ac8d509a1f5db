#include "hil/trace/cycle_words.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <string>

#include "hil/base/text.h"
#include "hil/trace/one_of_words.h"

namespace forcegate {
namespace {

constexpr std::array<std::string_view, 8> kRun = {"run", "record", "recording", "rec", "file", "test", "measurement", "trial"};
constexpr std::array<std::string_view, 3> kNumber = {"no", "nr", "number"};
constexpr std::array<std::string_view, 4> kSince = {"before", "since", "between", "prior"};

bool is_cycles(const std::string& word) { return word == "cycles" || word == "cycle"; }
bool is_number(const std::string& word) { return std::isdigit(static_cast<unsigned char>(word.front())) != 0; }

/// Words and whole numbers ("10k" and "2e3" are none, and neither are parts of "0.5"); what parts two sentences is a word of its own.
std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> out;
  std::string word;
  const auto end_word = [&] {
    if (!word.empty()) out.push_back(word);
    word.clear();
  };
  for (const char c : ascii_lower(text)) {
    const bool part = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (part || (c == '.' && !word.empty() && is_number(word))) {
      word += c;
      continue;
    }
    end_word();
    if (c == ';' || c == ',') out.emplace_back(1, c);
  }
  end_word();
  for (std::string& w : out)
    if (w.size() > 1 && w.back() == '.') w.pop_back();
  return out;
}

std::optional<double> whole_number(const std::string& word) {
  constexpr std::size_t kMostDigits = 12;
  if (word.size() > kMostDigits || !std::ranges::all_of(word, [](unsigned char c) { return std::isdigit(c) != 0; })) return std::nullopt;
  return std::stod(word);
}

}  // namespace

std::optional<double> cycles_in_words(std::string_view text) {
  const std::vector<std::string> words = words_of(text);
  std::optional<double> out;
  constexpr std::size_t kNear = 3;  // words between the number, "cycles" and what tells that they were before
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (!is_cycles(words[i])) continue;
    const std::size_t from = i > kNear ? i - kNear : 0, to = std::min(words.size(), i + kNear + 1);
    std::optional<double> number;
    for (std::size_t k = i; k-- > from && !number;) {
      if (!is_number(words[k])) continue;
      const bool after = k > 0 && words[k - 1] == "after";
      const bool told = after || std::any_of(words.begin() + static_cast<std::ptrdiff_t>(i) + 1, words.begin() + static_cast<std::ptrdiff_t>(to),
                                             [](const std::string& w) { return is_one_of(w, kSince); });
      if (told) number = whole_number(words[k]);
    }
    // "cycles since the last run: 200", "cycles_before 1500"
    if (!number && i + 1 < words.size() && is_one_of(words[i + 1], kSince))
      for (std::size_t k = i + 2; k < std::min(words.size(), i + 3 + kNear) && !number; ++k)
        if (is_number(words[k])) number = whole_number(words[k]);
    if (!number) continue;
    if (out) return std::nullopt;
    out = number;
  }
  return out;
}

std::vector<double> cycles_of_runs(std::string_view text, std::size_t records) {
  const std::vector<std::string> words = words_of(text);
  if (std::ranges::none_of(words, is_cycles)) return {};
  std::vector<double> out;
  // N [word] [word] before [run] [no] K
  for (std::size_t i = 1; i + 1 < words.size(); ++i) {
    if (words[i] != "before") continue;
    std::optional<double> count, run;
    constexpr std::size_t kBetween = 3;
    for (std::size_t k = i; k-- > (i > kBetween ? i - kBetween : 0) && !count && words[k] != ";" && words[k] != ",";)
      if (is_number(words[k])) count = whole_number(words[k]);
    bool of_run = false;
    for (std::size_t k = i + 1; k < words.size() && !run; ++k) {
      if (is_number(words[k])) run = whole_number(words[k]);
      else if (is_one_of(words[k], kRun)) of_run = true;
      else if (!is_one_of(words[k], kNumber)) break;
    }
    if (!count || !run || !of_run) continue;
    if (*run < 1.0 || *run > static_cast<double>(records)) return {};
    out.resize(records, 0.0);
    out[static_cast<std::size_t>(*run) - 1] += *count;
  }
  return out;
}

bool is_running_count(std::span<const double> counts) {
  return counts.size() >= 4 && std::ranges::is_sorted(counts) && std::set<double>(counts.begin(), counts.end()).size() >= 3;
}

}  // namespace forcegate
