#include "hil/trace/air_words.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "hil/trace/campaign.h"

namespace forcegate {
namespace {

TEST(AirWords, HumidityIsANumberBesideItsWord) {
  for (const char* text : {"slow press with the foot; RH 39 %", "39 % RH", "RH=39%", "rh 39", "39% r.H.", "humidity 39 percent", "humidity was 39 %", "39 % relative humidity",
                           "second day; RH 39 %, 12 presses", "39 %RH"}) {
    const AirNotes n = air_in_words(text);
    ASSERT_TRUE(n.humidity_pct.has_value()) << text;
    EXPECT_EQ(*n.humidity_pct, 39.0) << text;
    EXPECT_FALSE(n.temp_C.has_value()) << text;
  }
}

TEST(AirWords, TemperatureIsANumberInDegreesCelsius) {
  for (const char* text : {"room 21.5 \xc2\xb0" "C", "21.5 degC", "21,5\xc2\xb0" "C in the lab", "oven at 21.5 C, 39 % RH", "T = 21.5 C", "21.5 deg C", "temperature: 21.5 Celsius", "21.5\xe2\x84\x83"}) {
    const AirNotes n = air_in_words(text);
    ASSERT_TRUE(n.temp_C.has_value()) << text;
    EXPECT_EQ(*n.temp_C, 21.5) << text;
  }
  EXPECT_EQ(air_in_words("cold room at -5 C").temp_C, -5.0);
}

TEST(AirWords, DriveIsANumberInVoltBesideItsWord) {
  EXPECT_EQ(air_in_words("supply 3.3 V").drive_V, 3.3);
  EXPECT_EQ(air_in_words("battery at 2900 mV").drive_V, 2.9);
  EXPECT_FALSE(air_in_words("output up to 4.2 V").drive_V.has_value());
}

TEST(AirWords, WhatIsNoStateOfTheAirIsNone) {
  for (const char* text : {"", "40 % of the range", "3 presses", "specimen 2 C", "warmed by 3 degC", "0.2 degC/min", "20 to 25 degC", "20-25 degC", "21 +/- 0.5 degC within the hour", "from 22 degC to 45 degC",
                           "RH 40 % at first, RH 55 % later", "RH 140 %", "RH", "%", "deg", "rh 1/2", "12 RH sensors failed, 14 RH ones did not", "5 V range"}) {
    const AirNotes n = air_in_words(text);
    EXPECT_FALSE(n.temp_C || n.humidity_pct || n.drive_V) << text;
  }
}

TEST(AirWords, NotesOfACampaignStandInWhereNoKeyTellsTheAir) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "forcegate_air_words";
  std::filesystem::create_directories(folder);
  for (const char* name : {"a.csv", "b.csv"}) std::ofstream(folder / name) << "t_s,F_ref_N,U_V\n0,0,0\n0.01,1,2\n0.02,2,4\n0.03,1,2\n";
  std::ofstream(folder / "campaign.json") << R"({"records": [{"file": "a.csv", "note": "ramp; RH 39 %", "temp_C": 20, "room": "22 degC"},
                                                             {"file": "b.csv", "humidity": "41 %"}]})";
  const auto campaign = read_campaign(folder);
  ASSERT_TRUE(campaign.has_value()) << campaign.error().to_text();
  EXPECT_EQ(campaign->records.at(0).humidity_pct, 39.0);
  EXPECT_EQ(campaign->records.at(0).temp_C, 20.0) << "a key goes before words";
  EXPECT_EQ(campaign->records.at(1).humidity_pct, 41.0);
  EXPECT_FALSE(campaign->records.at(1).temp_C.has_value());
  EXPECT_TRUE(std::ranges::any_of(campaign->notes, [](const std::string& n) { return n.find("humidity of 2 records is taken from what campaign.json says") != std::string::npos; }));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace forcegate
