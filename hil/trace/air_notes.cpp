#include "hil/trace/air_notes.h"

#include <algorithm>
#include <array>
#include <string>

#include "hil/base/text.h"
#include "hil/trace/columns.h"

namespace forcegate {
namespace {

/// "room_temp" -> "temp", "rh_mean" -> "rh", "ambient" -> "".
std::string without_place(const std::string& name) {
  static constexpr std::array kWhere = {"room", "air", "ambient", "amb", "lab", "env", "mean", "avg", "average", "start"};
  std::string out;
  for (std::size_t from = 0; from <= name.size();) {
    const std::size_t to = std::min(name.find('_', from), name.size());
    const std::string word = name.substr(from, to - from), lower = ascii_lower(word);
    if (!word.empty() && std::none_of(kWhere.begin(), kWhere.end(), [&](const char* w) { return lower == w; }))
      out += (out.empty() ? "" : "_") + word;
    from = to + 1;
  }
  return out;
}

void take(const std::string& key, double value, AirNotes& out) {
  if (key == "T") return;  // a period as often as a temperature
  const ColumnMeaning meaning = meaning_of(key);
  const std::string name = without_place(meaning.name);
  const std::string known = known_name(name);
  const bool has_unit = meaning.note.empty() && !meaning.unit.symbol.empty();
  const double canonical = value * meaning.unit.factor + meaning.unit.offset;
  const bool temperature_unit = has_unit && meaning.unit.quantity == "temperature";
  if (!out.temp_C && (known == "temp" || (temperature_unit && (name.empty() || ascii_lower(name) == "t"))))
    out.temp_C = temperature_unit ? canonical : value;
  else if (!out.humidity_pct && known == "humidity")
    out.humidity_pct = has_unit ? 100.0 * canonical : value <= 1.0 ? 100.0 * value : value;
  else if (!out.drive_V && known == "drive" && meaning.unit.quantity == "voltage")
    out.drive_V = canonical;
}

}  // namespace

AirNotes air_notes(const std::vector<std::pair<std::string, double>>& numbers) {
  AirNotes out;
  for (const auto& [name, value] : numbers) take(name, value, out);
  return out;
}

void fill_in(AirNotes& out, const AirNotes& other) {
  for (const auto quantity : {&AirNotes::temp_C, &AirNotes::humidity_pct, &AirNotes::drive_V})
    if (!(out.*quantity)) out.*quantity = other.*quantity;
}

}  // namespace forcegate
