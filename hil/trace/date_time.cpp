#include "hil/trace/date_time.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>

#include "hil/base/iso_date.h"
#include "hil/base/utc_clock.h"

namespace forcegate {
namespace {

/// Reads `text` from the front, digit by digit.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  bool number(std::size_t digits, int& out) {
    if (text_.size() < digits) return false;
    out = 0;
    for (std::size_t i = 0; i < digits; ++i) {
      if (text_[i] < '0' || text_[i] > '9') return false;
      out = 10 * out + (text_[i] - '0');
    }
    text_.remove_prefix(digits);
    return true;
  }
  bool one_of(std::string_view characters) {
    if (text_.empty() || characters.find(text_.front()) == std::string_view::npos) return false;
    text_.remove_prefix(1);
    return true;
  }
  /// ".123" or ",123"; 0 when there is none.
  double fraction() {
    if (text_.size() < 2 || (text_[0] != '.' && text_[0] != ',') || text_[1] < '0' || text_[1] > '9')
      return 0.0;
    double value = 0.0, place = 0.1;
    for (text_.remove_prefix(1); !text_.empty() && text_[0] >= '0' && text_[0] <= '9';
         text_.remove_prefix(1), place *= 0.1)
      value += place * (text_[0] - '0');
    return value;
  }
  /// 'A' of " AM", 'P' of " pm"; 0 when there is neither.
  char half_of_day() {
    const std::string_view word = text_.starts_with(' ') ? text_.substr(1) : text_;
    if (word.size() < 2 || (word[1] | 0x20) != 'm' || ((word[0] | 0x20) != 'a' && (word[0] | 0x20) != 'p')) return 0;
    const char half = static_cast<char>(word[0] & ~0x20);
    text_ = word.substr(2);
    return half;
  }
  bool at_end() const { return text_.empty(); }

 private:
  std::string_view text_;
};

/// Days since 1970-01-01 in the Gregorian calendar (Hinnant, "chrono-compatible low-level date algorithms").
std::int64_t days_of(int year, int month, int day) {
  const std::int64_t y = year - (month <= 2 ? 1 : 0), era = y / 400, of_era = y - era * 400;
  const std::int64_t of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  return era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719468;
}

/// `beside_date`: "10:00" may be hours and minutes only, which alone it may not.
bool clock_time(Scanner& s, double& seconds, bool beside_date = false) {
  int hour = 0, minute = 0, second = 0;
  if ((!s.number(2, hour) && !s.number(1, hour)) || !s.one_of(":") || !s.number(2, minute)) return false;
  const bool has_seconds = s.one_of(":");
  if (has_seconds ? !s.number(2, second) : !beside_date) return false;
  if (hour > 23 || minute > 59 || second > 60) return false;
  const double fraction = has_seconds ? s.fraction() : 0.0;
  if (const char half = s.half_of_day(); half != 0) {
    if (hour < 1 || hour > 12) return false;
    hour = hour % 12 + (half == 'P' ? 12 : 0);
  }
  seconds += 3600.0 * hour + 60.0 * minute + second + fraction;
  return true;
}

/// "0.01 sec" as MATLAB writes a duration; "0.01 s" may be a cell of anything.
std::optional<double> duration_s(std::string_view text) {
  for (const auto& [word, factor] : {std::pair{std::string_view(" sec"), 1.0}, {" min", 60.0}, {" hr", 3600.0}, {" days", 86400.0}, {" day", 86400.0}}) {
    if (!text.ends_with(word)) continue;
    double value = 0.0;
    const char* const end = text.data() + text.size() - word.size();
    if (const auto [stop, error] = std::from_chars(text.data(), end, value); stop != end || error != std::errc() || !std::isfinite(value)) return std::nullopt;
    return factor * value;
  }
  return std::nullopt;
}

bool zone(Scanner& s, double& seconds) {
  if (s.at_end()) return true;
  s.one_of(" ");  // as many programs print it before the offset
  if (s.one_of("Z") && s.at_end()) return true;
  int hours = 0, minutes = 0;
  for (const auto& [sign, name] : {std::pair{-1.0, "+"}, std::pair{1.0, "-"}})
    if (s.one_of(name)) {
      if (!s.number(2, hours)) return false;
      s.one_of(":");
      if (!s.at_end() && !s.number(2, minutes)) return false;
      seconds += sign * (3600.0 * hours + 60.0 * minutes);
      return s.at_end();
    }
  return false;
}

bool is_date(int year, int month, int day) {
  return year >= 1970 && month >= 1 && month <= 12 && day >= 1 && day <= days_of_month(year, month);
}

}  // namespace

std::optional<double> seconds_of_stamp(std::string_view text) {
  if (const auto duration = duration_s(text)) return duration;
  if (text.size() < 7 || text[0] < '0' || text[0] > '9') return std::nullopt;
  double seconds = 0.0;
  if (Scanner s(text); clock_time(s, seconds) && s.at_end()) return seconds;
  int year = 0, month = 0, day = 0;
  Scanner iso(text), dotted(text);
  if (iso.number(4, year) && iso.one_of("-/") && iso.number(2, month) && iso.one_of("-/") &&
      iso.number(2, day) && iso.one_of("T ")) {
    seconds = 86400.0 * static_cast<double>(days_of(year, month, day));
    if (is_date(year, month, day) && clock_time(iso, seconds, true) && zone(iso, seconds)) return seconds;
  } else if (dotted.number(2, day) && dotted.one_of(".") && dotted.number(2, month) && dotted.one_of(".") &&
             dotted.number(4, year) && dotted.one_of("T ")) {
    seconds = 86400.0 * static_cast<double>(days_of(year, month, day));
    if (is_date(year, month, day) && clock_time(dotted, seconds, true) && dotted.at_end()) return seconds;
  }
  return std::nullopt;
}

bool has_zone(std::string_view stamp) {
  const std::size_t time = stamp.find(':');
  return time != std::string_view::npos && stamp.find_first_of("Z+-", time) != std::string_view::npos;
}

std::string stamp_of_seconds(double seconds) {
  constexpr double kYear_s = 365.0 * 86400.0;  // a clock of day may have passed midnights
  const double ms = std::round(seconds * 1e3);
  const std::string text = utc_text(std::floor(ms / 1e3));
  const std::string fraction = std::to_string(static_cast<int>(ms - 1e3 * std::floor(ms / 1e3)) + 1000).replace(0, 1, ".");
  constexpr std::size_t kDate = 11, kTime = 8;
  return (seconds < kYear_s ? text.substr(kDate, kTime) : text.substr(0, kDate + kTime)) + fraction;
}

std::optional<double> seconds_of_date(std::string_view text) {
  constexpr std::size_t kLength = 10;
  return text.size() == kLength ? seconds_of_stamp(std::string(text) + " 00:00:00") : std::nullopt;
}

}  // namespace forcegate
