// The last lines of bench, gate and recordings, in a folder that is not the source tree: each is pasted as it stands.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/support/last_line.h"

namespace forcegate::test {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr const char* kNative = FORCEGATE_BINARY_DIR "/firmware/reference.native.so";
constexpr const char* kTwin = FORCEGATE_SOURCE_DIR "/rigs/twin.toml";

class PastedLines : public ::testing::Test {
 protected:
  // Runs the command and gives its last line, which holds no placeholder.
  std::string next(const std::string& command, int exit_code = 0) {
    const ProcessResult r = pasted(command, folder);
    EXPECT_EQ(r.exit_code, exit_code) << command << "\n" << r.out << r.err;
    const std::string line = next_of(r);
    EXPECT_THAT(line, AllOf(Not(::testing::IsEmpty()), Not(HasSubstr(" FILE")), Not(HasSubstr("FIRMWARE")), Not(HasSubstr("...")))) << r.out;
    return line;
  }
  std::string looked_at(const std::string& command, int exit_code = 0) {
    const ProcessResult r = pasted(command, folder);
    EXPECT_EQ(r.exit_code, exit_code) << command << "\n" << r.out << r.err;
    const std::string file = file_to_look_at(r);
    EXPECT_NE(file, "") << r.out;
    EXPECT_NE(read_text(folder / file), "") << file;
    return file;
  }
  std::string recording(const std::string& name) {
    std::string csv = "time_s,load_N,volts_V\n";
    for (int i = 0; i < 6000; ++i) {
      char row[64];
      const double t = 0.01 * i, F = 2.0 + 1.5 * std::sin(0.6 * t);
      std::snprintf(row, sizeof row, "%.2f,%.5f,%.5f\n", t, F, 2.0 * F - 0.2 + 0.003 * std::sin(1e4 * t));
      csv += row;
    }
    write_text(folder / name, csv);
    return name;
  }
  const std::string native_ = kNative, twin_ = kTwin;
  TemporaryFolder folder;
};

TEST_F(PastedLines, TheListOfBenchesLeadsToTwinsThatAnswerAndToAGateOnThem) {
  const std::string doctor = next("forcegate bench list");
  EXPECT_THAT(doctor, AllOf(StartsWith("forcegate bench doctor /"), EndsWith(".toml")));
  const std::string gate = next(doctor);
  EXPECT_THAT(gate, AllOf(StartsWith("forcegate gate "), HasSubstr(" --rig "), EndsWith(" --plan twin")));
  EXPECT_EQ(looked_at(gate), "forcegate-run/report.html");
}

TEST_F(PastedLines, ABenchThatIsFreeOrWasJoggedIsAskedHowItIs) {
  const std::string doctor = "forcegate bench doctor " + twin_;
  EXPECT_EQ(next("forcegate bench who " + twin_), doctor);
  EXPECT_EQ(next("forcegate bench jog " + twin_ + " --angle 0.2"), doctor);
}

TEST_F(PastedLines, CalibratingGoesFromTheReferenceToASensorThatIsGatedWithIt) {
  std::string line = next("forcegate bench calibrate " + twin_ + " reference --masses 0,100,200,400 --yes");
  EXPECT_EQ(line, "forcegate bench calibrate " + twin_ + " spring");
  line = next(line);
  EXPECT_EQ(line, "forcegate bench calibrate " + twin_ + " sensor -o sensor.toml");
  line = next(line);
  EXPECT_THAT(line, AllOf(StartsWith("forcegate gate "), EndsWith(" --plan twin --cal sensor.toml")));
  EXPECT_THAT(looked_at(line), EndsWith("/report.html"));
}

TEST_F(PastedLines, ARealBenchIsNeverToldToMoveByItself) {
  write_text(folder / "my lab.toml", read_text(FORCEGATE_SOURCE_DIR "/rigs/lab_small.toml"));
  EXPECT_EQ(next("forcegate bench specimens 'my lab.toml'"), "gate your build with --rig 'my lab.toml' --arm when nobody reaches into the bench");
  EXPECT_EQ(next("forcegate bench list 'my lab.toml'"), "forcegate bench doctor 'my lab.toml'");
}

TEST_F(PastedLines, OneFaultIsShownByTheGateThatHasIt) {
  const std::string line = next("forcegate bench faults " + native_ + " --fault sensor_unplugged");
  EXPECT_EQ(line, "forcegate gate " + native_ + " --plan faults --fault sensor_unplugged=50 -o faulty");
  EXPECT_EQ(looked_at(line, 4), "faulty/report.html");
}

TEST_F(PastedLines, ARecordingIsDiagnosedWhereItsColumnsAreKnown) {
  recording("a run.csv");
  const std::string line = next("forcegate convert 'a run.csv' 'a run.h5' --map load_N=F_ref_N --map volts_V=U_V");
  EXPECT_EQ(line, "forcegate diagnose 'a run.h5'");
  EXPECT_THAT(next(line), StartsWith("forcegate "));
  EXPECT_EQ(pasted(next("forcegate convert 'a run.csv' other.csv --map load_N=p_N --map volts_V=q_V"), folder).exit_code, 0);
}

TEST_F(PastedLines, ThePlanOfARecordingLeadsToOne) {
  const ProcessResult r = pasted("forcegate plan replay", folder);
  EXPECT_EQ(next_of(r), "judge a recording of yours with it: forcegate gate " + native_ + " --record FILE");
  EXPECT_THAT(r.out, Not(HasSubstr("no specimen")));
}

TEST_F(PastedLines, AStoredRunIsCheckedAndItsPageMade) {
  ASSERT_EQ(pasted("forcegate gate " + native_ + " --plan selfcheck -o 'my run'", folder).exit_code, 0);
  const std::string line = next("forcegate check 'my run'");
  EXPECT_EQ(line, "forcegate report 'my run' --format html -o 'my run.html'");
  EXPECT_EQ(looked_at(line), "my run.html");
  const std::string other = next("forcegate check 'my run' --plan selfcheck");
  EXPECT_EQ(other, "forcegate check 'my run' --plan selfcheck -o judged.json");
  EXPECT_EQ(next(other), "forcegate report judged.json --format html -o judged.html");
}

TEST_F(PastedLines, WhatIsDerivedIsKeptLookedAtAndBlessedWithTheReasonThatWasGiven) {
  const std::string keep = next("forcegate limits " + native_ + " --count 10");
  EXPECT_EQ(keep, "forcegate limits " + native_ + " --count 10 -o limits.toml");
  const std::string look = next(keep);
  EXPECT_THAT(look, AllOf(StartsWith("forcegate bless limits.toml --reason 'derived for plan smoke "), EndsWith(" --who \"$(id -un)\" --dry-run")));
  const std::string bless = next("forcegate bless limits.toml --reason 'a new spring' --who 'A. Smith' --dry-run");
  EXPECT_EQ(bless, "forcegate bless limits.toml --reason 'a new spring' --who 'A. Smith'");
  EXPECT_THAT(next(look), AllOf(StartsWith("forcegate bless limits.toml --reason "), Not(HasSubstr("--dry-run"))));
}

TEST_F(PastedLines, ARigThatRepeatsGivesLimitsThatTheGateTakes) {
  const std::string line = next("forcegate bench repeatability " + native_ + " --count 5 -o limits.toml");
  EXPECT_EQ(line, "forcegate gate " + native_ + " --plan selfcheck --limits limits.toml");
  EXPECT_THAT(file_to_look_at(pasted(line, folder)), EndsWith("/report.html"));
  EXPECT_EQ(next("forcegate bench selfcheck " + native_), "forcegate gate " + native_);
}

// Counts of a load cell beside a sensor in a divider: both scales go with every line.
TEST_F(PastedLines, ALoadCellInCountsAndADividerAreCarriedOn) {
  std::string csv = "ms,hx711,adc\n";
  for (int i = 0; i < 12000; ++i) {
    const double t = 0.01 * i, F = 3.0 + 2.0 * std::sin(1.2 * t) + 0.8 * std::sin(0.2 * t), G = 4e-5 * F + 2e-6, noise = std::sin(1e4 * t);
    char row[64];
    std::snprintf(row, sizeof row, "%d,%.0f,%.0f\n", 10 * i, 84211.0 + 21543.0 * F + 40.0 * noise, 1024.0 * G * 1e4 / (1.0 + G * 1e4));
    csv += row;
  }
  write_text(folder / "arduino.csv", csv);
  const ProcessResult refused = pasted("forcegate diagnose arduino.csv", folder);
  EXPECT_THAT(refused.err, HasSubstr("--map hx711=F_ref_N:FACTOR:ZERO"));
  const std::string scales = " --map hx711=F_ref_N:1/21543:84211", whole = scales + " --divider 10k:1024";
  EXPECT_THAT(pasted("forcegate diagnose arduino.csv" + scales, folder).out, AllOf(HasSubstr("* static_nonlinearity"), HasSubstr("--divider OHMS:SUPPLY")));
  const std::string fit = next("forcegate diagnose arduino.csv" + whole);
  EXPECT_EQ(fit, "forcegate fit arduino.csv" + whole + " -o model.toml");
  const std::string exported = next(fit);
  EXPECT_THAT(exported, StartsWith("forcegate export model.toml"));
  EXPECT_THAT(pasted(exported + " --check arduino.csv" + whole, folder).out, HasSubstr("its input U is the conductance in S"));
}

}  // namespace
}  // namespace forcegate::test
