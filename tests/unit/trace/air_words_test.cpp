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

TEST(AirList, IsANumberForEachRecordBehindItsWords) {
  for (const char* text : {"RH % per run: 47 56 54.5 64", "note humidity of the runs in percent 47, 56, 54.5, 64", "RH%: 47; 56; 54.5; 64 (chamber)", "4 presses; RH of runs 47/56/54.5/64"}) {
    const std::vector<AirNotes> runs = air_in_list(text, 4);
    ASSERT_EQ(runs.size(), 4u) << text;
    EXPECT_EQ(runs[0].humidity_pct, 47.0) << text;
    EXPECT_EQ(runs[2].humidity_pct, 54.5) << text;
    EXPECT_FALSE(runs[3].temp_C.has_value()) << text;
  }
  const std::vector<AirNotes> air = air_in_list("air temperature at start of each run, degC: 10.0 -2.5 21.4; RH %: 40 41 42", 3);
  ASSERT_EQ(air.size(), 3u);
  EXPECT_EQ(air[1].temp_C, -2.5);
  EXPECT_EQ(air[2].humidity_pct, 42.0);
}

TEST(AirList, OfAnotherLengthOrOfAnotherThingIsNone) {
  for (const char* text : {"RH % per run: 47 56 54", "RH % per run: 47 56 54 64 65", "loads 1 2 3 4 N", "RH % 47 56 54 640", "runs 1 2 3 4", "", "RH % 1 2 3 4; humidity 5 6 7 8"}) {
    const std::vector<AirNotes> runs = air_in_list(text, 4);
    EXPECT_TRUE(std::ranges::none_of(runs, [](const AirNotes& n) { return n.temp_C || n.humidity_pct || n.drive_V; })) << text;
  }
  EXPECT_TRUE(air_in_list("RH 40 to 60 %, RH 40 60", 2).empty()) << "two numbers may be a range";
}

TEST(AirList, OfACampaignStandsInForItsRecords) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "forcegate_air_lists";
  std::filesystem::create_directories(folder);
  for (const char* name : {"a.csv", "b.csv", "c.csv"}) std::ofstream(folder / name) << "t_s,F_ref_N,U_V\n0,0,0\n0.01,1,2\n0.02,2,4\n0.03,1,2\n";
  std::ofstream(folder / "campaign.json") << R"({"note": "RH % per run: 47 56 54", "room_temp_degC": [21.5, 22, 23], "weights": [1, 2, 3],
    "records": [{"file": "a.csv", "note": "RH 39 %"}, {"file": "b.csv"}, {"file": "c.csv", "probes": [{"t_s": 0, "air_C": 30}, {"t_s": 9, "air_C": 32}]}]})";
  const auto campaign = read_campaign(folder);
  ASSERT_TRUE(campaign.has_value()) << campaign.error().to_text();
  EXPECT_EQ(campaign->records.at(0).humidity_pct, 39.0) << "what is said of the record itself goes first";
  EXPECT_EQ(campaign->records.at(1).humidity_pct, 56.0);
  EXPECT_EQ(campaign->records.at(0).temp_C, 21.5);
  EXPECT_EQ(campaign->records.at(2).temp_C, 31.0) << "the mean of its own readings";
  std::filesystem::remove_all(folder);
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
