#include "hil/trace/air_notes.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace forcegate {
namespace {

AirNotes notes(const char* json) { return air_notes(nlohmann::json::parse(json)); }

TEST(AirNotes, HumidityIsReadUnderAnyNameThatTellsIt) {
  for (const char* json : {R"({"rh_percent": 41})", R"({"RH": 41})", R"({"humidity": 0.41})", R"({"humidity_pct": 41})", R"({"relative_humidity_percent": 41})",
                           R"({"RH [%]": 41})", R"({"room_humidity": 41})", R"({"environment": {"rh": 41}})"}) {
    const AirNotes n = notes(json);
    ASSERT_TRUE(n.humidity_pct.has_value()) << json;
    EXPECT_NEAR(*n.humidity_pct, 41.0, 1e-9) << json;
    EXPECT_FALSE(n.temp_C.has_value()) << json;
  }
}

TEST(AirNotes, TemperatureIsReadInItsUnit) {
  for (const char* json : {R"({"temp_C": 23})", R"({"room_temp_degC": 23})", R"({"T_C": 23})", R"({"ambient_C": 23})", R"({"temperature_K": 296.15})",
                           R"({"T_room_C": 23})", R"({"air": {"temperature": 23}})"}) {
    const AirNotes n = notes(json);
    ASSERT_TRUE(n.temp_C.has_value()) << json;
    EXPECT_NEAR(*n.temp_C, 23.0, 1e-9) << json;
  }
}

TEST(AirNotes, DriveIsReadInVolt) {
  EXPECT_NEAR(notes(R"({"excitation_mV": 3300})").drive_V.value_or(0.0), 3.3, 1e-12);
  EXPECT_NEAR(notes(R"({"drive_V": 5})").drive_V.value_or(0.0), 5.0, 1e-12);
}

TEST(AirNotes, OtherNumbersAreNoAir) {
  const AirNotes n = notes(R"({"start_s": 1900, "A_N": 1.1, "m_N": 2, "f_min_Hz": 0.5, "T": 2.0, "duration_s": 60, "fs_Hz": 400, "eccentricity_mm": 11,
    "force_C": "no", "stimulus": {"temp_C": 90, "rh": 5}, "t": 4, "excitation_start_s": 2.0, "file": "a.csv", "records": [1, 2]})");
  EXPECT_FALSE(n.temp_C.has_value());
  EXPECT_FALSE(n.humidity_pct.has_value());
  EXPECT_FALSE(n.drive_V.has_value());
}

TEST(AirNotes, AnEmptyObjectTellsNothing) { EXPECT_FALSE(notes("{}").temp_C.has_value()); }

}  // namespace
}  // namespace forcegate
