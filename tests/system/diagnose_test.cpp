// Whatever the answer, the last line of a diagnosis says what to do next.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "tests/support/last_line.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;

std::string last_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

class DiagnoseSaysWhatIsNext : public ::testing::TestWithParam<const char*> {};

TEST_P(DiagnoseSaysWhatIsNext, WithAndWithoutAPage) {
  const TemporaryFolder folder;
  const ProcessOptions there{.folder = folder.path()};
  const ProcessResult made = forcegate({"mystery", "--seed", "5", "--effect", GetParam(), "--minutes", "3", "try"}, there);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  for (const bool page : {false, true}) {
    std::vector<std::string> arguments = {"diagnose", "try"};
    if (page) arguments.insert(arguments.end(), {"--html", "try.html"});
    const ProcessResult r = forcegate(arguments, there);
    ASSERT_EQ(r.exit_code, 0) << r.err;
    EXPECT_THAT(last_line(r.out), ::testing::StartsWith("next: forcegate ")) << r.out;
  }
}

INSTANTIATE_TEST_SUITE_P(Answers, DiagnoseSaysWhatIsNext, ::testing::Values("none", "hysteresis", "foreign_telegraph"),
                         [](const auto& one) { return std::string(one.param); });

TEST(Diagnose, ANoneNamesWhatIsSuspectedBesideItAndWhyItIsNotClaimed) {
  const TemporaryFolder folder;
  ASSERT_EQ(pasted("forcegate mystery --seed 8 m8", folder).exit_code, 0);
  const ProcessResult said = pasted("forcegate diagnose m8", folder);
  EXPECT_THAT(said.out, HasSubstr("verdict: nothing is missing that these records could show; but humidity or reference_drift is suspected and not claimed"));
  EXPECT_THAT(said.out, HasSubstr("not claimed: nobody recorded it"));
  EXPECT_THAT(said.out, HasSubstr("with one gain and zero for all, the error of records left out falls from"));
  EXPECT_EQ(next_of(said), "forcegate diagnose m8 --html diagnosis.html");
  EXPECT_EQ(next_of(pasted(next_of(said), folder)), "forcegate next m8");
}

// A time constant of an hour and records of five minutes: gain and zero of a record take nearly all of it, and their course is a witness too.
TEST(Diagnose, ACreepThatRunsOnFromRecordToRecordIsToldByTheirLevels) {
  const TemporaryFolder folder;
  ASSERT_EQ(pasted("forcegate mystery --seed 90828266004068 --minutes 5 --effect creep --strength medium creeps", folder).exit_code, 0);
  const ProcessResult said = pasted("forcegate diagnose creeps", folder);
  EXPECT_THAT(said.out, HasSubstr("* creep")) << said.out;
  EXPECT_THAT(said.out, HasSubstr("the rows within the records tell the same strength"));
  EXPECT_THAT(said.out, HasSubstr("held-out error, one gain and offset for all: "));
  const ProcessResult added = pasted("forcegate add creep --fit creeps -o better.toml", folder);
  EXPECT_THAT(read_text(folder / "better.toml"), HasSubstr("form = \"carried\"")) << added.out;
  EXPECT_THAT(added.out, ::testing::Not(HasSubstr("the error did not fall")));
}

TEST(Diagnose, AClaimThatHeldOutRecordsDoNotShowSaysSoAndDoesNotSendToAdd) {
  const TemporaryFolder folder;
  ASSERT_EQ(pasted("forcegate mystery --seed 3 m3", folder).exit_code, 0);
  const ProcessResult said = pasted("forcegate diagnose m3 --html m3.html", folder);
  EXPECT_THAT(said.out, HasSubstr("the error of every record, predicted from all others, falls from"));
  EXPECT_THAT(said.out, HasSubstr("note: the held-out records are described worse with what is claimed"));
  EXPECT_THAT(read_text(folder / "m3.html"), HasSubstr("Error of every record, predicted from the others"));
  EXPECT_EQ(next_of(said), "forcegate record --help");
}

TEST(Diagnose, AWeightInGramsIsAskedFor) {
  const TemporaryFolder folder;
  std::string csv = "t_s,load_g,U_V\n";
  for (int i = 0; i < 400; ++i) csv += std::to_string(0.01 * i) + "," + std::to_string(200.0 + 100.0 * std::sin(0.05 * i)) + ",1\n";
  write_text(folder.path() / "grams.csv", csv);
  const ProcessResult r = forcegate({"diagnose", "grams.csv"}, {.folder = folder.path()});
  EXPECT_NE(r.exit_code, 0);
  EXPECT_THAT(r.err, HasSubstr("--map load_g=F_ref_gf")) << "g alone may be an acceleration";
}

// Triangles that grow and shrink, of a film on a rubber that is soft up to the largest force of its record.
void write_softening(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::string records;
  std::mt19937 random(7);
  const auto noise = [&] { return 0.006 * (static_cast<double>(random()) / 4294967296.0 - 0.5); };
  for (int k = 0; k < 6; ++k) {
    std::string csv = "t_s,F_ref_N,U_V\n";
    double largest = 0.0;
    const double slow_s = k % 2 == 0 ? 20.0 : 8.0;
    for (int i = 0; i < 6000; ++i) {
      const double t = i / 100.0, phase = std::fmod(t / slow_s, 1.0);
      const double F = 0.2 + (1.5 + 0.5 * ((k + static_cast<int>(t / slow_s)) % 5)) * (phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase);
      largest = std::max(largest, F);
      const double U = 2.0 * (F + 0.03 * (largest - F) * F) + 0.2;
      char row[64];
      std::snprintf(row, sizeof row, "%.2f,%.4f,%.4f\n", t, F + noise(), U + noise());
      csv += row;
    }
    const std::string file = "r" + std::to_string(k) + ".csv";
    write_text(folder / file, csv);
    records += std::string(k == 0 ? "" : ", ") + R"({"file": ")" + file + R"(", "kind": "ramp", "dynamic": false, "start_s": )" +
               std::to_string(600 * k) + R"(, "role": ")" + (k % 3 == 2 ? "heldout" : "fit") + "\"}";
  }
  write_text(folder / "campaign.json", R"({"campaign": "softening", "records": [)" + records + "]}");
}

TEST(Diagnose, WhatTheLibraryDoesNotHaveIsSaidAndAnEquationOfTheUsersOwnTakesIt) {
  const TemporaryFolder folder;
  const ProcessOptions there{.folder = folder.path()};
  write_softening(std::filesystem::path(folder.path()) / "film");
  const ProcessResult asked = forcegate({"diagnose", "film"}, there);
  ASSERT_EQ(asked.exit_code, 0) << asked.err;
  EXPECT_THAT(asked.out, HasSubstr("structure remains that no effect of the library explains")) << asked.out;
  EXPECT_THAT(asked.out, HasSubstr("it follows the largest force so far"));

  write_text(folder / "mine.toml", R"(format = 1
[law]
kind = "static"
gain_N_per_V = { value = 0.5, se = 0.05, unit = "N/V" }
offset_N = { value = 0.0, se = 0.1, unit = "N" }
[[effect]]
name = "softening"
output = "k * (M - F) * F"
state.M = "F > M ? 50 * (F - M) : 0"
parameter.k = { value = 0.01, unit = "1/N" }
)");
  const ProcessResult added = forcegate({"add", "softening", "--model", "mine.toml", "--fit", "film", "-o", "better.toml"}, there);
  ASSERT_EQ(added.exit_code, 0) << added.err;
  const ProcessResult after = forcegate({"diagnose", "film", "--model", "better.toml"}, there);
  ASSERT_EQ(after.exit_code, 0) << after.err;
  EXPECT_THAT(after.out, ::testing::StartsWith("verdict: nothing is missing")) << added.out << after.out;
  EXPECT_EQ(forcegate({"history", "better.toml", "--on", "film"}, there).exit_code, 0);

  const ProcessResult wrong = forcegate({"add", "softning", "--model", "mine.toml", "--fit", "film"}, there);
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("did you mean \"softening\"?"));
}

}  // namespace
}  // namespace forcegate::test
