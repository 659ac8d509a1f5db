#pragma once
// What a lab wrote down of the air around a record and of the sensor's drive under names of its own.

#include <nlohmann/json_fwd.hpp>
#include <optional>

namespace forcegate {

struct AirNotes {
  std::optional<double> temp_C, humidity_pct, drive_V;
};

/// Numbers of a record's object whose key tells quantity and unit as a column header does: "rh_percent": 58, "room_temp_degC": 23,
/// "excitation_mV": 3300, or inside one object: "environment": {"T_C": 23, "RH": 0.41}. Words that only say where ("room", "air", "ambient",
/// "mean") do not count; humidity without a unit is a share up to 1 and in percent above.
AirNotes air_notes(const nlohmann::json& record);

}  // namespace forcegate
