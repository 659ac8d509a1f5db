#include "hil/trace/lab_notes.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "hil/base/text.h"
#include "hil/trace/date_time.h"
#include "hil/trace/one_of_words.h"

namespace forcegate {
namespace {

constexpr double kDay_s = 86400.0;  // a stamp below it is a time of day without its day

/// Words of letters or of digits.
std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> out;
  const auto kind = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0 ? 'd' : std::isalpha(static_cast<unsigned char>(c)) != 0 ? 'a' : ' '; };
  char last = ' ';
  for (const char c : ascii_lower(text)) {
    if (kind(c) == ' ') {
      last = ' ';
      continue;
    }
    if (kind(c) != last) out.emplace_back();
    out.back() += c;
    last = kind(c);
  }
  return out;
}

constexpr std::array<std::string_view, 4> kMounting = {"mounting", "mount", "fixture", "fixation"};
constexpr std::array<std::string_view, 3> kAgain = {"remount", "remounting", "refitted"};
constexpr std::array<std::string_view, 10> kMounted = {"mounted", "seated", "attached", "installed", "fixed", "glued", "taped", "bonded", "stuck", "cemented"};
// Weights are placed again too, and a specimen is clamped: only where the note speaks of the sensor.
constexpr std::array<std::string_view, 7> kPlaced = {"placed", "positioned", "inserted", "clamped", "centred", "centered", "aligned"};
constexpr std::array<std::string_view, 7> kSensor = {"sensor", "film", "flexiforce", "fsr", "pad", "puck", "sensors"};
constexpr std::array<std::string_view, 4> kAnew = {"again", "anew", "newly", "new"};
constexpr std::array<std::string_view, 5> kNot = {"not", "no", "without", "never", "before"};

bool says_remounted(const std::vector<std::string>& words) {
  if (std::ranges::any_of(words, [](const std::string& w) { return is_one_of(w, kNot); })) return false;
  if (std::ranges::any_of(words, [](const std::string& w) { return is_one_of(w, kAgain); })) return true;
  const bool of_sensor = std::ranges::any_of(words, [](const std::string& w) { return is_one_of(w, kSensor); });
  const auto mounted = [&](const std::string& w) { return is_one_of(w, kMounted) || (of_sensor && is_one_of(w, kPlaced)); };
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].starts_with("re") && mounted(words[i].substr(2))) return true;
    if (i + 1 == words.size()) break;
    if (words[i] == "re" && mounted(words[i + 1])) return true;
    if (mounted(words[i]) && is_one_of(words[i + 1], kAnew)) return true;
    if (is_one_of(words[i], kAnew) && (is_one_of(words[i + 1], kMounting) || mounted(words[i + 1]))) return true;
  }
  return false;
}

/// "2" of "mounting 2", "mounting no. 2", "mounting #2", "b" of "mounting b".
std::string numbered(const std::vector<std::string>& words) {
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (!is_one_of(words[i], kMounting)) continue;
    const std::size_t at = (words[i + 1] == "no" || words[i + 1] == "nr" || words[i + 1] == "number") && i + 2 < words.size() ? i + 2 : i + 1;
    const std::string& label = words[at];
    if (label.size() == 1 || std::isdigit(static_cast<unsigned char>(label.front())) != 0) return label;
  }
  return {};
}

void take_member(const std::string& key, const std::string& value, LabNotes& out) {
  const std::vector<std::string> of_key = words_of(key), of_value = words_of(value);
  if (says_remounted(of_key)) {
    out.remounted = out.remounted || (value != "false" && value != "0" && !value.empty());
    return;
  }
  const bool of_mounting = std::ranges::any_of(of_key, [](const std::string& w) { return is_one_of(w, kMounting); });
  if (of_mounting && of_value.size() == 1 && of_value.front() != "true" && of_value.front() != "false") {
    if (out.mounting.empty()) out.mounting = of_value.front();
    return;
  }
  if (out.mounting.empty()) out.mounting = numbered(of_value);
  out.remounted = out.remounted || says_remounted(of_value);
}

}  // namespace

LabNotes lab_notes(const std::vector<std::pair<std::string, std::string>>& members) {
  LabNotes out;
  for (const auto& [key, value] : members) {
    const std::optional<double> stamp = seconds_of_stamp(value);
    if (stamp && *stamp >= kDay_s) {
      if (!out.stamp_s) out.stamp_s = stamp;
    } else {
      take_member(key, value, out);
    }
  }
  return out;
}

}  // namespace forcegate
