#pragma once
// What a lab wrote down of the air around a record and of the sensor's drive under names of its own.

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace forcegate {

struct AirNotes {
  std::optional<double> temp_C, humidity_pct, drive_V;
};

/// Out of named numbers those whose name tells quantity and unit as a column header does: "rh_percent" 58, "room_temp_degC" 23,
/// "drive_mV" 3300. The first of a quantity counts. Words that only say where ("room", "air", "ambient",
/// "mean") do not count; humidity without a unit is a share up to 1 and in percent above.
AirNotes air_notes(const std::vector<std::pair<std::string, double>>& numbers);

/// What `out` does not know it takes from `other`.
void fill_in(AirNotes& out, const AirNotes& other);

}  // namespace forcegate
