// What export says of a header that is not worth building in.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/last_line.h"
#include "tests/support/noise.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

void write_straight(const std::string& path, double rad_per_s = 0.7) {
  Noise noise;
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.02 * i, F = 2.0 + 1.5 * std::sin(rad_per_s * t);
    text += std::to_string(t) + "," + std::to_string(F) + "," + std::to_string(2.0 * F + 0.2 + 0.002 * noise()) + "\n";
  }
  write_text(path, text);
}

constexpr const char* kCreeps =
    "format = 1\n[law]\nkind = \"static\"\nspan_N = 3\nlowest_N = 0.5\ngain_N_per_V = 0.5\noffset_N = -0.1\n"
    "[[effect]]\nname = \"mine\"\noutput = \"k * x\"\nstate.x = \"(F - x) / tau\"\nparameter.k = 0.2\nparameter.tau = 2\n";

TEST(Export, AHeaderThatMakesRecordsWorseEndsTheChain) {
  const TemporaryFolder folder;
  write_straight(folder / "film.csv");
  write_text(folder / "m.toml", kCreeps);
  const ProcessResult r = pasted("forcegate export m.toml --c comp.h --plan none --check film.csv", folder);
  EXPECT_EQ(r.exit_code, 1) << r.err;
  EXPECT_THAT(r.out, HasSubstr("(1 of 1 records): do not build it in"));
  EXPECT_EQ(next_of(r), "forcegate explain \"no gain\"");
  const ProcessResult explained = pasted(next_of(r), folder);
  EXPECT_EQ(explained.exit_code, 0) << explained.err;
  EXPECT_THAT(explained.out, HasSubstr("firmware with the law alone"));
}

TEST(Export, WhatWasNeverFittedIsSaidByEveryVerbThatMeetsIt) {
  const TemporaryFolder folder;
  write_straight(folder / "film.csv");
  write_text(folder / "m.toml", kCreeps);
  const ProcessResult exported = pasted("forcegate export m.toml --c comp.h --plan none", folder);
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  EXPECT_THAT(exported.out, HasSubstr("note: mine was never fitted (no parameter has an se): the header undoes it"));
  EXPECT_THAT(read_text(folder / "comp.h"), HasSubstr("mine: as written, never fitted."));
  for (const char* verb : {"forcegate compare film.csv --model m.toml", "forcegate fit film.csv --model m.toml"}) {
    const ProcessResult r = pasted(verb, folder);
    EXPECT_THAT(r.out + r.err, HasSubstr("note: mine was never fitted (no parameter has an se): only the error of the model as written counts it")) << verb;
  }
  const ProcessResult added = pasted("forcegate add mine --fit film.csv --model m.toml -o better.toml", folder);
  EXPECT_THAT(added.out + added.err, Not(HasSubstr("never fitted"))) << added.err;
  EXPECT_THAT(pasted("forcegate export better.toml --plan none", folder).out, Not(HasSubstr("never fitted")));
}

TEST(Export, WithoutEffectsThereIsOneErrorAndNotTwo) {
  const TemporaryFolder folder;
  write_straight(folder / "film.csv");
  write_text(folder / "m.toml", std::string(kCreeps).substr(0, std::string(kCreeps).find("[[")));
  const ProcessResult r = pasted("forcegate export m.toml --plan none --check film.csv", folder);
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("(the law alone):"));
  EXPECT_THAT(r.out, Not(HasSubstr(" -> ")));
  EXPECT_THAT(r.out, HasSubstr("held against the model's own inverse from 0 to 3.5 N"));
}

// The firmware of --plan none calibrates by the model: a straight line through the records would hide a wrong one.
TEST(Export, AGainThatIsNotThatOfTheRecordsIsAWarningWhereTheModelCalibrates) {
  const TemporaryFolder folder;
  write_straight(folder / "film.csv");
  write_text(folder / "wrong.toml", "format = 1\n[law]\nkind = \"static\"\nspan_N = 3\nlowest_N = 0.5\ngain_N_per_V = 0.3\noffset_N = 2.0\n");
  const ProcessResult r = pasted("forcegate export wrong.toml --c comp.h --plan none --check film.csv", folder);
  EXPECT_EQ(r.exit_code, 1) << r.err;
  EXPECT_THAT(r.out, HasSubstr("with gain and offset of the model, by which the firmware calibrates"));
  EXPECT_THAT(r.out, HasSubstr("with the best straight line instead"));
  EXPECT_THAT(r.out, HasSubstr("warning: gain and offset of the model are not those of these records"));
  EXPECT_EQ(next_of(r), "forcegate fit film.csv --model wrong.toml -o better.toml");
  EXPECT_EQ(pasted(next_of(r), folder).exit_code, 0);
  EXPECT_EQ(pasted("forcegate export better.toml --c comp.h --plan none --check film.csv", folder).exit_code, 0);
  const auto check = nlohmann::json::parse(pasted("forcegate export wrong.toml --plan none --check film.csv --json", folder).out)["check"];
  EXPECT_EQ(check["calibrated_by"], "model");
  EXPECT_GT(check["raw_compensated_rms_N"].get<double>(), 0.3);
  EXPECT_LT(check["compensated_rms_N"].get<double>(), 0.01);
  EXPECT_NEAR(check["line"]["gain"].get<double>(), 0.5 / 0.3, 0.01);
  // a plan finds gain and zero on the bench
  const ProcessResult planned = forcegate({"export", folder / "wrong.toml", "--check", folder / "film.csv"}, {.folder = FORCEGATE_SOURCE_DIR});
  EXPECT_EQ(planned.exit_code, 0) << planned.err;
  EXPECT_THAT(planned.out, HasSubstr("as the plan's calibration finds it on the bench"));
  EXPECT_THAT(planned.out, HasSubstr("gain and offset of the model instead"));
}

TEST(Export, AConductanceIsNotSoldAsAVoltage) {
  const TemporaryFolder folder;
  Noise noise;
  std::string text = "t_s,F_ref_N,R_ohm\n";
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.02 * i, F = 2.0 + 1.5 * std::sin(0.7 * t);
    text += std::to_string(t) + "," + std::to_string(F) + "," + std::to_string(1.0 / (5e-6 * F + 1e-6 + 1e-8 * noise())) + "\n";
  }
  write_text(folder / "film.csv", text);
  const ProcessResult fitted = pasted("forcegate fit film.csv -o model.toml", folder);
  ASSERT_EQ(fitted.exit_code, 0) << fitted.err;
  EXPECT_THAT(fitted.out, HasSubstr(" N/S\n"));
  EXPECT_THAT(read_text(folder / "model.toml"), testing::AllOf(HasSubstr("output_unit = \"S\""), HasSubstr("unit = \"N/S\"")));
  const ProcessResult exported = pasted("forcegate export model.toml --plan none --c comp.h --check film.csv", folder);
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  EXPECT_THAT(exported.out, HasSubstr("its input U is the conductance in S, 1/R with R in ohm: no voltage"));
  EXPECT_THAT(exported.out, Not(HasSubstr("LSB")));
  EXPECT_THAT(read_text(folder / "comp.h"), testing::AllOf(HasSubstr("U is the conductance in S"), HasSubstr("#define FG_COMP_INPUT_UNIT \"S\""), HasSubstr(" N/S, F0 ")));
  write_straight(folder / "volts.csv");
  const ProcessResult other = pasted("forcegate compare volts.csv --model model.toml", folder);
  EXPECT_THAT(other.out + other.err, HasSubstr("the model takes an output in S, and these records hold it in V"));
}

TEST(Export, NoPlaceToBuildTheHeaderInIsAnErrorOnlyWhereItIsToBeReplayed) {
  const TemporaryFolder folder;
  write_straight(folder / "film.csv");
  const ProcessOptions nowhere{.folder = folder.path(), .environment = {{"TMPDIR", "/nonexistent"}}};
  const ProcessResult checked = forcegate({"export", "flexiforce", "--plan", "none", "--check", "film.csv"}, nowhere);
  EXPECT_EQ(checked.exit_code, 2) << checked.err;
  EXPECT_THAT(checked.err, HasSubstr("where: TMPDIR\n  help: set TMPDIR"));
  const ProcessResult written = forcegate({"export", "flexiforce", "--plan", "none", "--c", "comp.h"}, nowhere);
  EXPECT_EQ(written.exit_code, 0) << written.err;
  EXPECT_THAT(written.out, HasSubstr("note: not held against the model's own inverse: there is no place to build the header in"));
}

TEST(Export, ARefusalLeavesNoModelWithoutItsHeader) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "films");
  for (const char* file : {"films/a.csv", "films/b.csv", "films/c.csv"}) write_straight(folder / file, 0.6 + 0.1 * static_cast<double>(file[6] - 'a'));
  const ProcessResult r = pasted("forcegate export flexiforce --plan none --fit films -o mine.toml --c comp.h --check nothing.csv", folder);
  EXPECT_EQ(r.exit_code, 2) << r.out;
  EXPECT_THAT(r.err, HasSubstr("nothing.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder / "mine.toml"));
  EXPECT_FALSE(std::filesystem::exists(folder / "comp.h"));
  EXPECT_EQ(pasted("forcegate export flexiforce --plan none --fit films -o mine.toml --c comp.h", folder).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "mine.toml"));
}

TEST(Export, ACompilerThatDoesNotStartOrGivesNoLibraryIsNoCompilerThatIsMissing) {
  const TemporaryFolder folder;
  write_straight(folder / "film.csv");
  std::filesystem::create_directory(folder / "bin");
  const auto with = [&](const std::string& path) {
    return forcegate({"export", "flexiforce", "--plan", "none", "--check", "film.csv"}, {.folder = folder.path(), .environment = {{"PATH", path}}});
  };
  EXPECT_THAT(with(folder / "nowhere").err, HasSubstr("there is no C compiler"));
  write_text(folder / "bin/cc", "#!/bin/sh\nexit 0\n");
  EXPECT_THAT(with(folder / "bin").err, HasSubstr("the C compiler cannot be started: Permission denied"));
  std::filesystem::permissions(folder / "bin/cc", std::filesystem::perms::owner_all);
  const ProcessResult none = with(folder / "bin");
  EXPECT_THAT(none.err, HasSubstr("the built header cannot be loaded: "));
  EXPECT_THAT(none.err, HasSubstr("No such file or directory"));
}

// Where no plan stands nobody knows at which rate a firmware runs, and the records tell the only one there is.
TEST(Export, IsOfferedAtTheRateOfTheRecordsWhereNoPlanStands) {
  const TemporaryFolder folder;
  write_straight(folder / "film.csv");
  ASSERT_EQ(pasted("mkdir bin && cp $(command -v forcegate) bin && bin/forcegate fit film.csv -o m.toml", folder).exit_code, 0);
  const ProcessResult away = pasted("bin/forcegate diagnose film.csv --model m.toml", folder);
  EXPECT_THAT(next_of(away), HasSubstr("forcegate export m.toml --plan none --rate 50 --c comp.h")) << away.out;
  EXPECT_THAT(next_of(pasted("forcegate diagnose film.csv --model m.toml", folder)), Not(HasSubstr("--rate")));
  const ProcessResult exported = pasted("forcegate export m.toml --plan none --c comp.h --check film.csv --json", folder);
  const auto json = nlohmann::json::parse(exported.out);
  EXPECT_DOUBLE_EQ(json["rate_Hz"], 1000.0);
  EXPECT_DOUBLE_EQ(json["recorded_rate_Hz"], 50.0);
  EXPECT_THAT(json["notes"].dump(), HasSubstr("needs --rate 50,"));
}

}  // namespace
}  // namespace forcegate::test
