#include "hil/trace/air_notes.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "hil/trace/campaign.h"

namespace forcegate {
namespace {

AirNotes note(const char* name, double value) { return air_notes({{name, value}}); }

TEST(AirNotes, HumidityIsReadUnderAnyNameThatTellsIt) {
  for (const auto& [name, value] : {std::pair{"rh_percent", 41.0}, {"RH", 41.0}, {"humidity", 0.41}, {"humidity_pct", 41.0}, {"relative_humidity_percent", 41.0},
                                    {"RH [%]", 41.0}, {"room_humidity", 41.0}, {"rh_mean", 0.41}}) {
    const AirNotes n = note(name, value);
    ASSERT_TRUE(n.humidity_pct.has_value()) << name;
    EXPECT_NEAR(*n.humidity_pct, 41.0, 1e-9) << name;
    EXPECT_FALSE(n.temp_C.has_value()) << name;
  }
}

TEST(AirNotes, TemperatureIsReadInItsUnit) {
  for (const auto& [name, value] : {std::pair{"temp_C", 23.0}, {"room_temp_degC", 23.0}, {"T_C", 23.0}, {"ambient_C", 23.0}, {"temperature_K", 296.15},
                                    {"T_room_C", 23.0}, {"temperature", 23.0}}) {
    const AirNotes n = note(name, value);
    ASSERT_TRUE(n.temp_C.has_value()) << name;
    EXPECT_NEAR(*n.temp_C, 23.0, 1e-9) << name;
  }
}

TEST(AirNotes, DriveIsReadInVolt) {
  EXPECT_NEAR(note("drive_mV", 3300.0).drive_V.value_or(0.0), 3.3, 1e-12);
  EXPECT_NEAR(note("drive_V", 5.0).drive_V.value_or(0.0), 5.0, 1e-12);
}

TEST(AirNotes, OtherNumbersAreNoAir) {
  for (const char* name : {"start_s", "A_N", "m_N", "f_min_Hz", "T", "duration_s", "fs_Hz", "eccentricity_mm", "t", "excitation_start_s", "excitation_V", "number", ""}) {
    const AirNotes n = note(name, 2.0);
    EXPECT_FALSE(n.temp_C || n.humidity_pct || n.drive_V) << name;
  }
}

TEST(AirNotes, AreFoundInARecordAndInItsObjectsButNotInItsStimulus) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(::testing::TempDir()) / "forcegate_air_notes";
  fs::create_directories(folder);
  std::ofstream(folder / "r.csv") << "t_s,F_ref_N,U_V\n0,0,0\n0.1,1,2\n0.2,2,4\n0.3,1,2\n";
  std::ofstream(folder / "campaign.json") << R"({"records": [{"file": "r.csv", "environment": {"T_C": 23, "RH": 0.41}, "stimulus": {"drive_mV": 90}}]})";
  const auto campaign = read_campaign(folder);
  fs::remove_all(folder);
  ASSERT_TRUE(campaign) << campaign.error().to_text();
  EXPECT_EQ(campaign->records.at(0).temp_C, 23.0);
  EXPECT_NEAR(campaign->records.at(0).humidity_pct.value_or(0.0), 41.0, 1e-9);
  EXPECT_FALSE(campaign->records.at(0).drive_V.has_value());
}

}  // namespace
}  // namespace forcegate
