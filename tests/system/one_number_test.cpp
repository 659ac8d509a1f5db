// A quantity has one value in every output: console, JSON, page, model file and its history.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/last_line.h"
#include "tests/support/noise.h"

namespace forcegate::test {
namespace {

struct Level {
  double gain, zero_V;
};

/// Records of steps to 0.5 .. 5 N, one for each level of the sensor.
void write_levels(const TemporaryFolder& folder, const std::string& name, const std::vector<Level>& levels) {
  std::filesystem::create_directory(folder.path() / name);
  Noise noise;
  for (int r = 0; r < std::ssize(levels); ++r) {
    const Level& level = levels[static_cast<std::size_t>(r)];
    std::string csv = "t_s,F_ref_N,U_V\n";
    double force = 0.0;
    for (int i = 0; i < 6000; ++i) {
      const int target = (i / 500 * 7 + 3 * r) % 11;
      force += 0.2 * (0.5 * target - force);
      char row[96];
      std::snprintf(row, sizeof row, "%.2f,%.4f,%.5f\n", 0.02 * i, force + 0.01 * noise(), 0.3 * force * level.gain + level.zero_V + 0.003 * noise());
      csv += row;
    }
    write_text(folder / (name + "/r" + std::to_string(r + 1) + ".csv"), csv);
  }
}

/// From the fourth record on the sensor lies otherwise: gain -15 %, zero +50 mV.
void write_overload(const TemporaryFolder& folder) {
  constexpr Level kBefore{1.0, 0.1}, kAfter{0.85, 0.15};
  write_levels(folder, "overload", {kBefore, kBefore, kBefore, kAfter, kAfter, kAfter});
}

// What add and then history tell; null, and a failure, where one of them ends otherwise.
std::pair<nlohmann::json, nlohmann::json> added_and_asked(const std::string& add, const TemporaryFolder& folder) {
  const ProcessResult added = pasted(add, folder), asked = pasted("forcegate history better.toml --on overload --json", folder);
  EXPECT_EQ(added.exit_code, 0) << added.err;
  EXPECT_EQ(asked.exit_code, 0) << asked.err;
  if (added.exit_code != 0 || asked.exit_code != 0) return {};
  return {nlohmann::json::parse(added.out), nlohmann::json::parse(asked.out)};
}

TEST(OneNumber, TheWaterfallOfAHistoryBeginsAndEndsWhereItsStepDoes) {
  const TemporaryFolder folder;
  write_overload(folder);
  const auto [add, history] = added_and_asked("forcegate add mounting --fit overload -o better.toml --json", folder);
  ASSERT_FALSE(add.is_null() || history.is_null());
  const double before = history["steps"][0]["error_before"], after = history["steps"][0]["error_after"];
  EXPECT_DOUBLE_EQ(add["error_before"], before);
  EXPECT_DOUBLE_EQ(add["waterfall"]["start"], before);
  EXPECT_DOUBLE_EQ(add["waterfall"]["end"], after);
  EXPECT_NEAR(history["waterfall"]["start"], before, 0.005 * before);
  EXPECT_NEAR(history["waterfall"]["end"], after, 0.005 * after);
}

// An equation of one's own stands in its file before it is added.
TEST(OneNumber, TheWaterfallOfAnOwnEquationBeginsAndEndsWhereItsStepDoes) {
  const TemporaryFolder folder;
  write_overload(folder);
  write_text(folder / "m.toml", "format = 1\n[law]\nkind = \"static\"\ngain_N_per_V = 3\noffset_N = 0\n[[effect]]\nname = \"mine\"\noutput = \"k * F^2\"\nparameter.k = 0.1\n"
                                "[[effect]]\nname = \"left\"\noutput = \"j * F^3\"\nparameter.j = 0.1\n");
  const auto [add, history] = added_and_asked("forcegate add mine --fit overload --model m.toml -o better.toml --json", folder);
  ASSERT_FALSE(add.is_null() || history.is_null());
  const double before = add["error_before"], after = add["error_after"];
  EXPECT_NEAR(history["waterfall"]["start"], before, 0.005 * before);
  EXPECT_NEAR(history["waterfall"]["end"], after, 0.005 * after);
  ASSERT_EQ(history["waterfall"]["bars"].size(), 1U);
  ASSERT_EQ(history["notes"].size(), 1U) << history["notes"];
  EXPECT_NE(history["notes"][0].get<std::string>().find("left was never fitted"), std::string::npos);
}

TEST(OneNumber, ThePartsOfOneRecordingAreNoRecords) {
  const TemporaryFolder folder;
  Noise noise;
  std::string csv = "t_s,F_ref_N,U_mV\n";
  for (int i = 0; i < 15000; ++i) {
    const double t = 0.02 * i, force = 3.0 - 2.0 * std::cos(0.7 * t) - 0.9 * std::cos(0.23 * t);
    char row[96];
    std::snprintf(row, sizeof row, "%.2f,%.4f,%.3f\n", t, force, 1e6 * (1.0 - std::exp(-force / 6.0)) + 300.0 * noise());
    csv += row;
  }
  write_text(folder / "bent.csv", csv);
  const ProcessResult said = pasted("forcegate diagnose bent.csv", folder);
  EXPECT_THAT(said.out, ::testing::HasSubstr(" of 5 parts of the recording that it touches improve")) << said.out;
  EXPECT_THAT(said.out, ::testing::Not(::testing::HasSubstr("records left out"))) << said.out;
  EXPECT_THAT(said.out, ::testing::Not(::testing::ContainsRegex("falls from [0-9.]*e"))) << "as it stands in the line of the errors";
}

TEST(OneNumber, TheRecordOfAMountingIsCountedFromOneEverywhere) {
  const TemporaryFolder folder;
  write_overload(folder);
  const ProcessResult said = pasted("forcegate diagnose overload --html page.html", folder);
  EXPECT_THAT(said.out, ::testing::HasSubstr("  record = 4 ")) << said.out;
  EXPECT_THAT(read_text(folder / "page.html"), ::testing::HasSubstr("<dt>record</dt><dd>4</dd>"));
  const auto json = nlohmann::json::parse(pasted("forcegate diagnose overload --json", folder).out);
  EXPECT_EQ(json["findings"][0]["parameters"][0]["name"], "record");
  EXPECT_EQ(json["findings"][0]["parameters"][0]["value"], 4.0);
  ASSERT_EQ(pasted("forcegate add mounting --fit overload -o better.toml", folder).exit_code, 0);
  EXPECT_THAT(read_text(folder / "better.toml"), ::testing::HasSubstr("shape.record = { value = 4.0"));
  EXPECT_THAT(pasted("forcegate explain mounting", folder).out, ::testing::HasSubstr("counted from one"));
}

TEST(OneNumber, MountingsThatNobodyWroteDownGoIntoTheModelAsTheyWereFound) {
  const TemporaryFolder folder;
  constexpr Level kFirst{1.0, 0.1}, kSecond{0.85, 0.1}, kThird{1.1, 0.1};
  write_levels(folder, "thrice", {kFirst, kFirst, kFirst, kSecond, kSecond, kSecond, kThird, kThird});
  const ProcessResult said = pasted("forcegate diagnose thrice", folder);
  EXPECT_THAT(said.out, ::testing::AllOf(::testing::HasSubstr("  record_2 = 4 "), ::testing::HasSubstr("  record_3 = 7 "))) << said.out;
  ASSERT_EQ(pasted("forcegate add mounting --fit thrice -o better.toml", folder).exit_code, 0);
  EXPECT_THAT(read_text(folder / "better.toml"), ::testing::AllOf(::testing::HasSubstr("form = \"two_steps\""), ::testing::HasSubstr("shape.record_2 = { value = 4.0"),
                                                                  ::testing::HasSubstr("shape.record_3 = { value = 7.0")));
  EXPECT_THAT(pasted("forcegate diagnose thrice --model better.toml", folder).out, ::testing::HasSubstr("verdict: nothing is missing"));
}

// Nothing foretells the record of the third mounting; the diagnosis, what it says of its finding and the model with it leave it out alike.
TEST(OneNumber, AMountingWithOneRecordIsInNoErrorOfLeftOutRecords) {
  const TemporaryFolder folder;
  constexpr Level kFirst{1.0, 0.1}, kSecond{0.85, 0.1}, kThird{1.1, 0.1};
  write_levels(folder, "lone", {kFirst, kFirst, kFirst, kFirst, kSecond, kSecond, kSecond, kSecond, kSecond, kThird});
  const auto answer = nlohmann::json::parse(pasted("forcegate diagnose lone --json", folder).out);
  const auto& finding = answer["findings"][0];
  ASSERT_EQ(finding["effect"], "mounting");
  EXPECT_DOUBLE_EQ(finding["error_after"].get<double>(), answer["error_after"].get<double>());
  EXPECT_LT(answer["error_after"].get<double>(), 0.1 * answer["error_before"].get<double>());
  EXPECT_THAT(pasted("forcegate diagnose lone", folder).out, ::testing::HasSubstr("no other record has the mounting of "));
  const auto model = nlohmann::json::parse(pasted("forcegate add mounting --fit lone -o better.toml --json", folder).out);
  EXPECT_NEAR(model["error_after"].get<double>(), answer["error_after"].get<double>(), 1e-3 * answer["error_after"].get<double>());
}

// An effect between records is claimed by one number for each record, and rows would choose another form of it.
TEST(OneNumber, WhatIsAddedIsWhatWasClaimedBetweenTheRecords) {
  const TemporaryFolder folder;
  ASSERT_EQ(pasted("forcegate mystery --effect humidity --strength strong --minutes 5 --seed 8644036 air", folder).exit_code, 0);
  const auto answer = nlohmann::json::parse(pasted("forcegate diagnose air --json", folder).out);
  const auto& finding = answer["findings"][0];
  ASSERT_EQ(finding["effect"], "humidity");
  const auto added = nlohmann::json::parse(pasted("forcegate add humidity --fit air -o better.toml --json", folder).out);
  EXPECT_NEAR(added["error_before"].get<double>(), answer["error_before"].get<double>(), 0.01 * answer["error_before"].get<double>());
  EXPECT_NEAR(added["error_after"].get<double>(), answer["error_after"].get<double>(), 0.01 * answer["error_after"].get<double>());
  for (const auto& told : finding["parameters"])
    for (const auto& p : added["parameters"])
      if (p["name"] == "humidity." + told["name"].get<std::string>()) {
        EXPECT_NEAR(p["after"].get<double>(), told["value"].get<double>(), 0.05 * std::abs(told["value"].get<double>()));
      }
}

// On the records that are fitted the best dead zone of all would have a strength that none has.
TEST(OneNumber, WhatIsClaimedCanBeAdded) {
  const TemporaryFolder folder;
  ASSERT_EQ(pasted("forcegate mystery --seed 13 m13", folder).exit_code, 0);
  const auto answer = nlohmann::json::parse(pasted("forcegate diagnose m13 --json", folder).out);
  ASSERT_EQ(answer["findings"][0]["effect"], "dead_zone");
  const auto added = nlohmann::json::parse(pasted("forcegate add dead_zone --fit m13 -o better.toml --json", folder).out);
  EXPECT_EQ(added["accepted"], true);
  EXPECT_LT(added["error_after"].get<double>(), 0.1 * added["error_before"].get<double>());
}

// A lead that is added has a claim to what a late reference would be forgiven.
TEST(OneNumber, ALeadIsAddedFromWhereItWasClaimed) {
  const TemporaryFolder folder;
  ASSERT_EQ(pasted("forcegate mystery --seed 16 m16", folder).exit_code, 0);
  const auto answer = nlohmann::json::parse(pasted("forcegate diagnose m16 --json", folder).out);
  ASSERT_EQ(answer["findings"][0]["effect"], "piezocapacitance");
  const auto added = nlohmann::json::parse(pasted("forcegate add piezocapacitance --fit m16 --json", folder).out);
  EXPECT_NEAR(added["error_before"].get<double>(), answer["error_before"].get<double>(), 0.01 * answer["error_before"].get<double>());
}

TEST(OneNumber, ALateReferenceIsNoErrorOfTheModelToAnyCommand) {
  const TemporaryFolder folder;
  ASSERT_EQ(pasted("forcegate mystery --seed 7 --effect hysteresis --strength medium --minutes 3 loop", folder).exit_code, 0);
  const auto diagnosed = nlohmann::json::parse(pasted("forcegate diagnose loop --json", folder).out);
  const auto added = nlohmann::json::parse(pasted("forcegate add hysteresis --fit loop -o better.toml --json", folder).out);
  const auto compared = nlohmann::json::parse(pasted("forcegate diagnose loop --model better.toml --json", folder).out);
  const double promised = diagnosed["error_after"], kept = added["error_after"], found = compared["error_before"];
  EXPECT_LT(promised, 0.5 * diagnosed["error_before"].get<double>());
  EXPECT_NEAR(kept, promised, 0.25 * promised);
  EXPECT_NEAR(found, kept, 0.25 * kept);
}

// Its force goes both ways, and the film conducts nothing at nobody knows which.
TEST(OneNumber, ACellTaredUnderAPreloadHasErrorsAndTheSameAnswer) {
  constexpr double kTare_N = 2.5;
  const TemporaryFolder folder;
  ASSERT_EQ(pasted("forcegate mystery --seed 7 --effect hysteresis --strength medium --minutes 3 loop", folder).exit_code, 0);
  std::filesystem::create_directory(folder.path() / "tared");
  for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "loop")) {
    if (entry.path().extension() != ".csv") continue;
    std::ifstream in(entry.path());
    std::string out, line;
    std::getline(in, line);
    ASSERT_TRUE(line.starts_with("t_s,F_ref_N,")) << line;
    out = line + "\n";
    while (std::getline(in, line)) {
      const std::size_t from = line.find(',') + 1, to = line.find(',', from);
      const std::string force = line.substr(from, to - from);
      out += line.substr(0, from) + (force.empty() ? force : std::to_string(std::stod(force) - kTare_N)) + line.substr(to) + "\n";
    }
    write_text(folder.path() / "tared" / entry.path().filename(), out);
  }
  const auto answer = nlohmann::json::parse(pasted("forcegate diagnose tared --json", folder).out);
  EXPECT_GT(answer["floor"].get<double>(), 0.0);
  EXPECT_GT(answer["error_before"].get<double>(), answer["error_after"].get<double>());
  EXPECT_GE(answer["error_after"].get<double>(), answer["floor"].get<double>());
  EXPECT_EQ(answer["findings"][0]["effect"], "hysteresis");
}

// Three slow triangles of a sensor without any decay, which nobody described.
TEST(OneNumber, CompareAndSimulateAgreeOnWhatIsCyclic) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "slow");
  Noise noise;
  for (const char* name : {"a", "b", "c"}) {
    std::string csv = "t_s,F_ref_N,U_V\n";
    for (int i = 0; i < 9000; ++i) {
      const double t = 0.02 * i, force = 0.5 + 4.0 * std::abs(2.0 * (t / 20.0 - std::floor(t / 20.0 + 0.5)));
      char row[96];
      std::snprintf(row, sizeof row, "%.2f,%.4f,%.5f\n", t, force, 0.2 + 2.0 * (force - 0.1) + 0.004 * noise());
      csv += row;
    }
    write_text(folder / ("slow/" + std::string(name) + ".csv"), csv);
  }
  const auto compared = nlohmann::json::parse(pasted("forcegate compare slow --json", folder).out);
  const auto simulated = nlohmann::json::parse(pasted("forcegate simulate slow -o out --json", folder).out);
  for (std::size_t k = 0; k < 3; ++k) {
    const double written = compared["as_written"][k]["rmse_V"], made = simulated["records"][k]["rmse_V"];
    EXPECT_LT(written, 0.5) << "no decay is written into what does not decay";
    EXPECT_NEAR(made, written, 1e-3 * written);
  }
}

TEST(OneNumber, TheErrorAgainstTheRigsLawIsThatOfTheClaim) {
  const TemporaryFolder folder;
  ASSERT_EQ(pasted("forcegate mystery --seed 24 m24", folder).exit_code, 0);
  const auto answer = nlohmann::json::parse(pasted("forcegate diagnose m24 --json", folder).out);
  const auto& finding = answer["findings"][0];
  ASSERT_EQ(finding["effect"], "backlash");
  EXPECT_NEAR(answer["errors"]["F"]["after"].get<double>(), finding["error_after"].get<double>(), 0.01 * finding["error_after"].get<double>());
}

}  // namespace
}  // namespace forcegate::test
