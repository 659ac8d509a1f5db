// What to measure next, recorded by hand: the force that is asked for becomes a file, its recording is given back, and the odds
// move. Nothing of the old campaign changes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr double kDelay_s = 0.03;

std::string row(double t_s, double force_N, double output_V) {
  std::ostringstream out;
  out.precision(7);
  out << t_s << ',' << force_N << ',' << output_V << '\n';
  return out.str();
}

// One sine of 0.5 Hz, the output 30 ms late with 3 mV of noise: a delay, a lag and a share of the rate are the same here, each with a
// probability of 0.27. Which two of them the next segment parts is no matter of the sensor.
constexpr const char* kTwoOfThree = "parts (delay|lag|viscous) / (delay|lag|viscous)";
std::string slow_sine() {
  std::string text = "t,F,U\n";
  std::uint32_t state = 1;
  const auto force_N = [](double t_s) { return 2.0 + 1.2 * std::sin(std::numbers::pi * t_s); };
  for (int i = 0; i < 6000; ++i) {
    double noise = 0.0;
    for (int k = 0; k < 12; ++k) noise += ((state = state * 1664525u + 1013904223u) >> 8) / 16777216.0 - 0.5;
    const double t_s = 0.01 * i;
    text += row(t_s, force_N(t_s), 1.0 + 0.9 * force_N(t_s - kDelay_s) + 0.003 * noise);
  }
  return text;
}

// The same sensor under the force of a profile (t_s,F_ref_N).
std::string recorded(const std::string& profile) {
  std::vector<double> t_s, force_N;
  std::istringstream in(profile);
  std::string line;
  for (std::getline(in, line); std::getline(in, line);) {
    t_s.push_back(std::stod(line));
    force_N.push_back(std::stod(line.substr(line.find(',') + 1)));
  }
  std::string text = "t_s,F_ref_N,U_V\n";
  std::size_t late = 0;
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    while (late + 1 < t_s.size() && t_s[late + 1] <= t_s[i] - kDelay_s) ++late;
    text += row(t_s[i], force_N[i], 1.0 + 0.9 * force_N[late]);
  }
  return text;
}

TEST(NextVerb, ARecordingOfTheForceThatWasAskedForSettlesWhatOneSineCannot) {
  TemporaryFolder folder;
  const std::string sine = folder / "sine.csv", still = folder / "still.csv", out = folder / "more";
  write_text(sine, slow_sine());
  const std::string before = read_text(sine);
  std::string rest = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 3000; ++i) rest += row(0.01 * i, 1.0, 1.9);
  write_text(still, rest);

  const ProcessResult asked = forcegate({"next", sine});
  EXPECT_EQ(asked.exit_code, 0) << asked.err;
  EXPECT_THAT(asked.out, AllOf(ContainsRegex(kTwoOfThree), ContainsRegex("next: forcegate next [^\n]*sine.csv -o [^\n]*sine-next\n")));
  // no rig holds this sensor: the forces to record are written
  const std::string forces = folder / "forces";
  const ProcessResult written = forcegate({"next", sine, "-o", forces});
  EXPECT_EQ(written.exit_code, 0) << written.err;
  EXPECT_THAT(written.out, AllOf(HasSubstr("/profiles/1_"), HasSubstr("--run --record FILE"), ContainsRegex("next: forcegate stimulus replay path=")));
  EXPECT_FALSE(fs::exists(fs::path(forces) / "campaign.json"));

  // the plan starts from what the diagnosis says of the two
  const auto said = nlohmann::json::parse(forcegate({"diagnose", sine, "--json"}).out),
             plan = nlohmann::json::parse(forcegate({"next", sine, "--json"}).out);
  std::map<std::string, double> probability;
  for (const auto& f : said["findings"]) probability[f["effect"]] = f["probability"];
  const auto& segment = plan["segments"][0];
  const std::string rivals = segment["separates"];
  const std::size_t at = rivals.find(" / ");
  const double a = probability[rivals.substr(0, at)], b = probability[rivals.substr(at + 3)];
  ASSERT_GT(std::min(a, b), 0.0) << rivals;
  EXPECT_EQ(segment["odds_from"], "probability");
  EXPECT_NEAR(segment["odds_before"].get<double>(), std::max(a, b) / std::min(a, b), 1e-6);
  EXPECT_EQ(said["next_experiment"]["segments"], plan["segments"]);
  // text and JSON name what `forcegate stimulus` takes
  for (const auto& s : plan["segments"]) {
    std::vector<std::string> words = {"stimulus", s["stimulus"]};
    if (s["stimulus"] == "replay") words.push_back("path=" + forces + "/" + s["profile"].get<std::string>());
    for (const auto& [name, value] : s["numbers"].items()) {
      std::string text;
      for (const auto& one : value.is_array() ? value : nlohmann::json::array({value})) text += (text.empty() ? "" : ",") + one.dump();
      words.push_back(name + "=" + text);
    }
    const ProcessResult played = forcegate(words);
    EXPECT_EQ(played.exit_code, 0) << played.err;
    EXPECT_THAT(asked.out, HasSubstr("forcegate stimulus " + s["stimulus"].get<std::string>() + " "));
  }

  const ProcessResult unlike = forcegate({"next", sine, "--run", "--record", still, "-o", out});
  EXPECT_EQ(unlike.exit_code, 2);
  EXPECT_THAT(unlike.err, HasSubstr("none of the recordings is like it; the force to play is"));
  EXPECT_THAT(unlike.err, AllOf(HasSubstr("the nearest, still.csv, has 30 s, 1 to 1 N, 0 N/s on the average"), HasSubstr("asked for are"), ContainsRegex("where: [^\n]*still.csv\n")));
  fs::path profile;
  for (const auto& file : fs::directory_iterator(fs::path(out) / "profiles"))
    if (profile.empty() || file.path() < profile) profile = file.path();
  ASSERT_FALSE(profile.empty());
  EXPECT_FALSE(fs::exists(fs::path(out) / "campaign.json"));

  const std::string played = folder / "played.csv";
  write_text(played, recorded(read_text(profile)));
  const ProcessResult done = forcegate({"next", sine, "--run", "--record", played, "-o", out});
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, AllOf(HasSubstr("played.csv"), ContainsRegex("to 1 before, .* now for (delay|lag)"),
                              HasSubstr("before: unknown"), ContainsRegex("now:    known, delay"),
                              HasSubstr("next: forcegate add delay --fit ")));
  const auto list = nlohmann::json::parse(read_text(out + "/campaign.json"));
  ASSERT_EQ(list["records"].size(), 2u);
  EXPECT_EQ(list["records"][1]["file"], "played.csv");
  EXPECT_FALSE(list["records"][1].contains("kind")) << "nobody declared what the sine is";
  EXPECT_EQ(read_text(sine), before);
}

// A lag of a millisecond is a delay to every segment that a rig can play.
TEST(NextVerb, ASegmentThatPartsNothingIsNotAskedFor) {
  TemporaryFolder folder;
  const std::string campaign = folder / "late";
  const ProcessResult made = forcegate({"mystery", "--seed", "22", "--effect", "lag", "--strength", "weak", campaign});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const ProcessResult asked = forcegate({"next", campaign, "--json"});
  ASSERT_EQ(asked.exit_code, 0) << asked.err;
  const ProcessResult elsewhere = forcegate({"next", campaign, "--run", "--rig", "emulated", "--specimen", "q99999", "--seed", "3"});
  EXPECT_EQ(elsewhere.exit_code, 2);
  EXPECT_THAT(elsewhere.err, HasSubstr("--rig, --specimen, --seed: a mystery is played on its own sensor"));
  const auto plan = nlohmann::json::parse(asked.out);
  for (const auto& segment : plan["segments"])
    EXPECT_GE(segment["odds_after"].get<double>(), 1.19 * segment["odds_before"].get<double>()) << segment["name"];
}

TEST(NextVerb, WhereOneEffectExplainsItAllTheNextStepIsToAddIt) {
  TemporaryFolder folder;
  std::string text = "t,F,U\n";
  double play = 0.0;
  for (int i = 0; i < 9000; ++i) {
    const double t_s = 0.02 * i, phase = t_s / (t_s < 90.0 ? 20.0 : 45.0),
                 force_N = 0.5 + 3.0 * std::abs(2.0 * (phase - std::floor(phase)) - 1.0);
    play = std::min(std::max(play, force_N - 0.4), force_N + 0.4);
    text += row(t_s, force_N, 1.0 + 1.1 * force_N + 0.15 * play + 0.002 * std::sin(977.0 * i * i));
  }
  const std::string file = folder / "loop.csv";
  write_text(file, text);
  const ProcessResult r = forcegate({"next", file});
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(r.out, AllOf(HasSubstr("nothing competes with hysteresis"), HasSubstr("next: forcegate add hysteresis --fit ")));
  // the same answer for who wanted to play or to write
  const std::string out = folder / "more";
  const ProcessResult run = forcegate({"next", file, "--run", "-o", out}), written = forcegate({"next", file, "-o", out});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("nothing competes with hysteresis"), HasSubstr("nothing was played"), HasSubstr("next: forcegate add hysteresis --fit ")));
  EXPECT_EQ(written.exit_code, 0) << written.err;
  EXPECT_THAT(written.out, HasSubstr("nothing was written to " + out));
  EXPECT_FALSE(fs::exists(out));
  EXPECT_EQ(nlohmann::json::parse(forcegate({"next", file, "--run", "--json"}).out), nlohmann::json::parse(forcegate({"next", file, "--json"}).out));
}

TEST(NextVerb, CopiesRecordsOutOfSubfoldersAndForgetsTheCopyWhereTheRunFails) {
  TemporaryFolder folder;
  const fs::path campaign = fs::path(folder / "bench"), out = fs::path(folder / "more");
  fs::create_directories(campaign / "day1");
  write_text((campaign / "day1" / "sine.csv").string(), slow_sine());
  write_text((campaign / "campaign.json").string(), R"({"campaign": "bench", "records": [{"file": "day1/sine.csv"}]})");
  const ProcessResult written = forcegate({"next", campaign.string(), "-o", out.string()});
  ASSERT_EQ(written.exit_code, 0) << written.err;
  fs::path profile;
  for (const auto& file : fs::directory_iterator(out / "profiles"))
    if (profile.empty() || file.path() < profile) profile = file.path();
  ASSERT_FALSE(profile.empty());
  const std::string force = recorded(read_text(profile.string())), wrong = folder / "campaign.json", played = folder / "played.csv";
  write_text(wrong, force);
  write_text(played, force);
  const auto run = [&](const std::string& record) { return forcegate({"next", campaign.string(), "--run", "--record", record, "-o", out.string()}); };

  const ProcessResult failed = run(wrong);
  EXPECT_EQ(failed.exit_code, 2);
  EXPECT_THAT(failed.err, HasSubstr("there is such a record already"));
  EXPECT_FALSE(fs::exists(out / "campaign.json")) << "a copy without its records must not stand in the way";
  EXPECT_FALSE(fs::exists(out / "day1"));
  EXPECT_TRUE(fs::exists(profile)) << "forces that somebody asked for stay";

  // a recording may be saved in the folder that was made for it; one that is not named stands in the way
  const std::string inside = (out / "rec1.csv").string();
  fs::rename(played, inside);
  write_text((out / "other.csv").string(), "t_s,F_ref_N,U_V\n");
  const ProcessResult other = run(inside);
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, AllOf(HasSubstr("the output exists already, and holds other.csv"), HasSubstr("name every recording in it with --record")));
  EXPECT_TRUE(fs::exists(inside));
  fs::remove(out / "other.csv");

  const ProcessResult done = run(inside);
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(fs::exists(out / "day1" / "sine.csv"));
  EXPECT_TRUE(fs::exists(inside));
  EXPECT_EQ(nlohmann::json::parse(read_text((out / "campaign.json").string()))["records"].size(), 2u);
}

}  // namespace
}  // namespace forcegate::test
