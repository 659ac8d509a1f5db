#include "hil/trace/air_words.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/text.h"

namespace forcegate {
namespace {

struct Token {
  std::string word;  // letters in lower case, or one other character; empty of a number
  double value = std::numeric_limits<double>::quiet_NaN();

  bool is_number() const { return word.empty(); }
};

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }
bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

/// "23.5" and "23,5"; the sign counts where nothing stands before it that a range begins with.
std::size_t take_number(std::string_view text, std::size_t at, bool negative, std::vector<Token>& out) {
  std::string digits;
  std::size_t end = at;
  bool point = false;
  for (; end < text.size(); ++end) {
    const bool separates = (text[end] == '.' || text[end] == ',') && !point && end + 1 < text.size() && is_digit(text[end + 1]);
    if (!is_digit(text[end]) && !separates) break;
    point |= separates;
    digits += separates ? '.' : text[end];
  }
  Token token;
  std::from_chars(digits.data(), digits.data() + digits.size(), token.value);
  if (negative) token.value = -token.value;
  out.push_back(token);
  return end;
}

/// `lists`: a minus behind a blank and before a digit is a sign, also behind a number.
std::vector<Token> tokens_of(std::string_view text, bool lists = false) {
  constexpr std::string_view kDegree = "\xc2\xb0", kDegreeC = "\xe2\x84\x83", kPlusMinus = "\xc2\xb1";
  std::vector<Token> out;
  for (std::size_t i = 0; i < text.size();) {
    const std::string_view rest = text.substr(i);
    const auto takes = [&](std::string_view sign, const char* word) {
      if (!rest.starts_with(sign)) return false;
      out.push_back({word, 0.0});
      i += sign.size();
      return true;
    };
    if (takes(kDegree, "deg") || takes(kDegreeC, "degc") || takes(kPlusMinus, "within") || takes("+/-", "within") || takes("+-", "within")) continue;
    const bool begins = out.empty() || !out.back().is_number() || (lists && text[i - 1] == ' ');
    if (is_digit(text[i])) {
      i = take_number(text, i, false, out);
    } else if (text[i] == '-' && begins && rest.size() > 1 && is_digit(rest[1])) {
      i = take_number(text, i + 1, true, out);
    } else if (is_letter(text[i])) {
      const auto end = std::ranges::find_if_not(rest, is_letter);
      out.push_back({ascii_lower(rest.substr(0, static_cast<std::size_t>(end - rest.begin()))), 0.0});
      i += out.back().word.size();
    } else {
      if (text[i] != ' ' && text[i] != '.' && text[i] != '=' && text[i] != ':' && text[i] != '_') out.push_back({std::string(1, text[i]), 0.0});
      ++i;
    }
  }
  return out;
}

/// One number of a text, and what stands around it.
class Place {
 public:
  Place(const std::vector<Token>& tokens, std::size_t at) : tokens_(tokens), at_(at) {}

  bool follows(std::size_t behind, std::initializer_list<std::string_view> words) const { return is_one_of(at_ + behind, words); }
  bool stands_before(std::size_t reach, std::initializer_list<std::string_view> words) const {
    for (std::size_t k = 1; k <= reach && k <= at_; ++k) {
      if (tokens_[at_ - k].is_number()) return false;
      if (is_one_of(at_ - k, words)) return true;
    }
    return false;
  }
  bool stands_behind(std::size_t reach, std::initializer_list<std::string_view> words) const {
    for (std::size_t k = 1; k <= reach && at_ + k < tokens_.size(); ++k) {
      if (tokens_[at_ + k].is_number()) return false;
      if (is_one_of(at_ + k, words)) return true;
    }
    return false;
  }
  /// "by 3", "within 0.5", "20 to 25", "20 - 25", "+2".
  bool is_change() const {
    const bool of_range = at_ >= 2 && tokens_[at_ - 2].is_number() && is_one_of(at_ - 1, {"to", "-", "and"});
    return of_range || stands_before(1, {"by", "within", "+", "than", "rise", "drop", "delta"});
  }
  bool is_rate(std::size_t unit) const { return is_one_of(at_ + unit + 1, {"/", "per", "a"}); }
  double value() const { return tokens_[at_].value; }

 private:
  bool is_one_of(std::size_t at, std::initializer_list<std::string_view> words) const {
    return at < tokens_.size() && !tokens_[at].is_number() && std::ranges::find(words, tokens_[at].word) != words.end();
  }

  const std::vector<Token>& tokens_;
  std::size_t at_;
};

bool is_temperature(const Place& p) {
  if (p.follows(1, {"degc", "celsius"})) return !p.is_rate(1);
  if (p.follows(1, {"deg", "degrees", "grad"}) && p.follows(2, {"c", "celsius"})) return !p.is_rate(2);
  // a coulomb, a specimen C
  return p.follows(1, {"c"}) && !p.is_rate(1) && p.stands_before(2, {"t", "temp", "temperature", "room", "air", "ambient", "lab", "oven", "chamber", "climate", "at"});
}

bool is_humidity(const Place& p) {
  const std::initializer_list<std::string_view> kHumidity = {"rh", "humidity", "humid", "moisture"};
  const bool of_percent = p.follows(1, {"%", "percent", "pct"});
  if (of_percent && p.follows(2, {"r"}) && p.follows(3, {"h"})) return true;
  return (p.stands_before(of_percent ? 3 : 1, kHumidity) && !p.follows(1, {"/"})) || (of_percent && p.stands_behind(3, kHumidity));
}

bool is_drive(const Place& p) {
  return p.follows(1, {"v", "mv", "volt"}) && !p.is_rate(1) && p.stands_before(2, {"drive", "supply", "excitation", "excited", "bias", "vcc", "vdd", "battery"});
}

/// One value, or several that are the same.
class OneValue {
 public:
  void add(double value) {
    differ_ |= value_ && *value_ != value;
    value_ = value;
  }
  std::optional<double> get() const { return differ_ ? std::nullopt : value_; }

 private:
  std::optional<double> value_;
  bool differ_ = false;
};

constexpr double kColdest_C = -60.0, kHottest_C = 200.0, kMostDrive_V = 60.0;

/// Numbers of a list, from `begin` on, one behind the other or parted by a mark.
std::vector<double> numbers_from(const std::vector<Token>& tokens, std::size_t begin) {
  constexpr std::array<std::string_view, 4> kMarks = {",", ";", "/", "|"};
  std::vector<double> out;
  for (std::size_t i = begin; i < tokens.size(); ++i) {
    const bool parts = !tokens[i].is_number() && i + 1 < tokens.size() && tokens[i + 1].is_number() && std::ranges::find(kMarks, tokens[i].word) != kMarks.end();
    if (!tokens[i].is_number() && !parts) break;
    if (tokens[i].is_number()) out.push_back(tokens[i].value);
  }
  return out;
}

bool has_word(const std::vector<Token>& tokens, std::size_t begin, std::size_t end, std::initializer_list<std::string_view> words) {
  return std::any_of(tokens.begin() + static_cast<std::ptrdiff_t>(begin), tokens.begin() + static_cast<std::ptrdiff_t>(end),
                     [&](const Token& t) { return !t.is_number() && std::ranges::find(words, t.word) != words.end(); });
}

}  // namespace

std::vector<AirNotes> air_in_list(std::string_view text, std::size_t records) {
  constexpr std::size_t kFewest = 3;  // two numbers are as often a range
  const std::vector<Token> tokens = tokens_of(text, true);
  std::vector<AirNotes> out;
  bool several = false;
  const auto take = [&](const std::vector<double>& values, std::optional<double> AirNotes::*quantity, double least, double most) {
    if (out.empty()) out.resize(values.size());
    several |= (out.front().*quantity).has_value();
    if (std::ranges::all_of(values, [&](double v) { return v >= least && v <= most; }))
      for (std::size_t k = 0; k < values.size(); ++k) out[k].*quantity = values[k];
  };
  for (std::size_t i = 0, said = 0; i < tokens.size(); ++i) {
    if (!tokens[i].is_number()) continue;
    const std::vector<double> values = numbers_from(tokens, i);
    if (records >= kFewest && values.size() == records) {
      if (has_word(tokens, said, i, {"rh", "humidity", "moisture"})) take(values, &AirNotes::humidity_pct, 0.0, 100.0);
      else if (has_word(tokens, said, i, {"degc", "celsius"}) || (has_word(tokens, said, i, {"c", "deg"}) && has_word(tokens, said, i, {"t", "temp", "temperature", "temperatures", "air", "room", "oven", "chamber"})))
        take(values, &AirNotes::temp_C, kColdest_C, kHottest_C);
    }
    while (i + 1 < tokens.size() && (tokens[i + 1].is_number() || (i + 2 < tokens.size() && tokens[i + 2].is_number() && tokens[i + 1].word.size() == 1))) ++i;
    said = i + 1;
  }
  if (several) out.clear();
  return out;
}

AirNotes air_in_words(std::string_view text) {
  const std::vector<Token> tokens = tokens_of(text);
  OneValue temp_C, humidity_pct, drive_V;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    if (!tokens[i].is_number()) continue;
    const Place place(tokens, i);
    const double value = place.value();
    // a range or a change beside a value leaves it open which of them held
    if (is_temperature(place)) temp_C.add(place.is_change() || value < kColdest_C || value > kHottest_C ? std::nan("") : value);
    else if (is_humidity(place)) humidity_pct.add(place.is_change() || value < 0.0 || value > 100.0 ? std::nan("") : value);
    else if (is_drive(place)) {
      const double volts = place.follows(1, {"mv"}) ? 1e-3 * value : value;
      drive_V.add(place.is_change() || volts > kMostDrive_V ? std::nan("") : volts);
    }
  }
  const auto told = [](const OneValue& v) { return v.get() && std::isfinite(*v.get()) ? v.get() : std::nullopt; };
  return {.temp_C = told(temp_C), .humidity_pct = told(humidity_pct), .drive_V = told(drive_V)};
}

}  // namespace forcegate
