#include "hil/trace/sensor_name.h"

#include <algorithm>

#include "hil/base/text.h"

namespace forcegate {

namespace {

// Not within a longer word: "fsrc" is no sensor, "FSRs", "U_FSR_V" and "fsr402" are.
bool has_word(std::string_view text, std::string_view word) {
  const auto is_letter = [&](std::size_t at) { return at < text.size() && text[at] >= 'a' && text[at] <= 'z'; };
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    std::size_t end = at + word.size();
    if (end < text.size() && text[end] == 's') ++end;
    if ((at == 0 || !is_letter(at - 1)) && !is_letter(end)) return true;
  }
  return false;
}

}  // namespace

NamedSensor sensor_named_in(std::string_view text) {
  const std::string lower = ascii_lower(text);
  if (lower.find("flexiforce") != std::string::npos) return NamedSensor::flexiforce;
  const auto has = [&](std::string_view word) { return has_word(lower, word); };
  return has("fsr") || has("interlink") || has("force sensing resistor") || has("force-sensing resistor") ? NamedSensor::fsr : NamedSensor::none;
}

std::string only_sensor_named(const std::vector<std::string>& texts) {
  const std::string* first = nullptr;
  for (const std::string& text : texts) {
    const NamedSensor sensor = sensor_named_in(text);
    if (sensor == NamedSensor::none) continue;
    if (first != nullptr && sensor != sensor_named_in(*first)) return {};
    if (first == nullptr) first = &text;
  }
  if (first == nullptr) return {};
  const std::size_t begin = first->find_first_not_of("#% \t");
  return begin == std::string::npos ? std::string{} : printable_utf8(std::string_view(*first).substr(begin));
}

}  // namespace forcegate
