// What read_campaign does about a campaign.json whose values its records contradict.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hil/trace/campaign.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class DeclaredFacts : public FolderTest {
 protected:
  // 40 s at 50 Hz: 2 N and 1 N about it at 0.5 Hz
  void SetUp() override {
    FolderTest::SetUp();
    std::string cycled = "t_s,F_ref_N,U_V\n", ramp = cycled;
    for (int i = 0; i < 2000; ++i) {
      const double t_s = 0.02 * i, F_N = 2.0 + std::sin(std::numbers::pi * t_s);
      cycled += std::to_string(t_s) + "," + std::to_string(F_N) + "," + std::to_string(2.0 * F_N) + "\n";
      ramp += std::to_string(t_s) + "," + std::to_string(0.1 * t_s) + "," + std::to_string(0.2 * t_s) + "\n";
    }
    put("a.csv", cycled);
    put("ramp.csv", ramp);
  }
  Campaign read(const std::string& facts, const std::string& file = "a.csv") const {
    put("campaign.json", R"({"records": [{"file": ")" + file + R"(")" + (facts.empty() ? "" : ", " + facts) + "}]}");
    auto campaign = read_campaign(folder_);
    EXPECT_TRUE(campaign) << (campaign ? "" : campaign.error().to_text());
    return campaign ? std::move(*campaign) : Campaign{};
  }
};

TEST_F(DeclaredFacts, SayNothingWhereTheyFitTheRecord) {
  const Campaign c = read(R"("kind": "sine", "fs_Hz": 52, "excitation_start_s": 3, "f_min_Hz": 0.5, "A_N": 1.1, "m_N": 2.2, "dynamic": true, "temp_C": 40, "humidity_pct": 99)");
  EXPECT_THAT(c.notes, Not(Contains(HasSubstr("campaign.json says"))));
  EXPECT_EQ(c.records[0].A_N, 1.1);
  EXPECT_THAT(read(R"("kind": "ramp", "dynamic": false, "excitation_start_s": 2)", "ramp.csv").notes, Not(Contains(HasSubstr("campaign.json says"))));
}

TEST_F(DeclaredFacts, AnExcitationThatBeginsBehindTheEndIsNotUsed) {
  for (const char* start : {"250", "1e6"}) {
    const Campaign c = read(R"("excitation_start_s": )" + std::string(start));
    EXPECT_FALSE(c.records[0].excitation_start_s) << start;
    EXPECT_THAT(c.notes, Contains(AllOf(HasSubstr("a: campaign.json says excitation_start_s"), HasSubstr("the record ends at 40 s"), HasSubstr("not used"))));
  }
  EXPECT_TRUE(read(R"("excitation_start_s": 39)", "ramp.csv").records[0].excitation_start_s);
}

TEST_F(DeclaredFacts, AnExcitationThatBeginsInTheMidstOfCyclesIsNotUsed) {
  const Campaign c = read(R"("excitation_start_s": 22)");
  EXPECT_FALSE(c.records[0].excitation_start_s);
  EXPECT_THAT(c.notes, Contains(AllOf(HasSubstr("a: campaign.json says excitation_start_s 22 s"), HasSubstr("the force turned 22 times without a rest up to then"), HasSubstr("not used"))));
  EXPECT_TRUE(read(R"("excitation_start_s": 6)").records[0].excitation_start_s) << "a learning phase";
}

TEST_F(DeclaredFacts, CyclesBeforeARestAreNoContradiction) {
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 3000; ++i) {
    const double t_s = 0.02 * i, F_N = t_s > 20.0 && t_s < 30.0 ? 2.0 : 2.0 + std::sin(std::numbers::pi * t_s);
    text += std::to_string(t_s) + "," + std::to_string(F_N) + "," + std::to_string(2.0 * F_N) + "\n";
  }
  put("rested.csv", text);
  EXPECT_TRUE(read(R"("excitation_start_s": 30)", "rested.csv").records[0].excitation_start_s);
  EXPECT_FALSE(read(R"("excitation_start_s": 45)", "rested.csv").records[0].excitation_start_s);
}

TEST_F(DeclaredFacts, AClockThatGoesOnFromOtherRecordsIsNoContradiction) {
  std::string late = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 2000; ++i) late += std::to_string(1000.0 + 0.02 * i) + "," + std::to_string(2.0 + std::sin(0.1 * i)) + ",1\n";
  put("late.csv", late);
  for (const char* start : {"3", "1003"}) EXPECT_TRUE(read(R"("excitation_start_s": )" + std::string(start), "late.csv").records[0].excitation_start_s) << start;
  EXPECT_FALSE(read(R"("excitation_start_s": 1041)", "late.csv").records[0].excitation_start_s);
}

TEST_F(DeclaredFacts, PeakToPeakIsNoHalfOfIt) {
  const Campaign c = read(R"("A_N": 2.0)");
  EXPECT_FALSE(c.records[0].A_N);
  EXPECT_THAT(c.notes, Contains(AllOf(HasSubstr("A_N 2 N"), HasSubstr("by 1 N to either side"), HasSubstr("not used"))));
  const Campaign quarter = read(R"("A_N": 0.5)");
  EXPECT_EQ(quarter.records[0].A_N, 0.5) << "unlikely, and not impossible";
  EXPECT_THAT(quarter.notes, Contains(AllOf(HasSubstr("A_N 0.5 N"), HasSubstr("what is declared counts"))));
}

TEST_F(DeclaredFacts, AMiddleBeyondEverySampleIsNotUsed) {
  const Campaign c = read(R"("A_N": 1, "m_N": 20)");
  EXPECT_FALSE(c.records[0].m_N);
  EXPECT_THAT(c.notes, Contains(AllOf(HasSubstr("m_N 20 N"), HasSubstr("runs from 1 to 3 N"))));
  const Campaign off = read(R"("A_N": 1, "m_N": 2.7)");
  EXPECT_EQ(off.records[0].m_N, 2.7);
  EXPECT_THAT(off.notes, Contains(AllOf(HasSubstr("m_N 2.7 N"), HasSubstr("about 2 N"))));
}

TEST_F(DeclaredFacts, TurnsInAMinuteAreNoHertz) {
  const Campaign c = read(R"("kind": "sine", "f_min_Hz": 30)");
  EXPECT_FALSE(c.records[0].f_min_Hz);
  EXPECT_THAT(c.notes, Contains(AllOf(HasSubstr("f_min_Hz 30 Hz"), HasSubstr("no cycles above 0.5 Hz"), HasSubstr("turns in a minute"))));
  EXPECT_THAT(read(R"("kind": "sine", "f_min_Hz": 0.05)").notes, Contains(AllOf(HasSubstr("f_min_Hz 0.05 Hz"), HasSubstr("has 0.5 Hz"))));
  EXPECT_THAT(read(R"("kind": "multisine", "f_min_Hz": 0.05)").notes, Not(Contains(HasSubstr("campaign.json says")))) << "a slow part may be small";
}

TEST_F(DeclaredFacts, ACycledRecordThatIsCalledStaticIsTold) {
  const Campaign c = read(R"("kind": "sine", "dynamic": false)");
  EXPECT_EQ(c.records[0].dynamic, false) << "what is declared counts";
  EXPECT_THAT(c.notes, Contains(AllOf(HasSubstr("a (40 turns, about 0.5 Hz): campaign.json says \"dynamic\": false"), HasSubstr("the record is taken for quasi-static"), HasSubstr("say true"))));
  EXPECT_THAT(read(R"("kind": "ramp", "dynamic": false)").notes, Not(Contains(HasSubstr("\"dynamic\""))));
  EXPECT_THAT(read(R"("dynamic": true)", "ramp.csv").notes, Contains(AllOf(HasSubstr("\"dynamic\": true"), HasSubstr("never turns"))));
}

TEST_F(DeclaredFacts, ARateBesideTheClockIsTold) {
  const Campaign c = read(R"("fs_Hz": 400)");
  EXPECT_THAT(c.notes, Contains(AllOf(HasSubstr("fs_Hz 400 Hz"), HasSubstr("50 Hz, which counts"))));
  EXPECT_NEAR(c.records[0].trace.time_bases[0].nominal_rate_Hz, 50.0, 0.01);
}

TEST_F(DeclaredFacts, AirThatCannotBeIsNotUsed) {
  const Campaign c = read(R"("temp_C": 2000, "humidity_pct": 150)");
  EXPECT_FALSE(c.records[0].temp_C);
  EXPECT_FALSE(c.records[0].humidity_pct);
  EXPECT_THAT(c.notes, Contains(AllOf(HasSubstr("the temperature 2000 degC"), HasSubstr("not used"))));
  EXPECT_THAT(c.notes, Contains(AllOf(HasSubstr("the humidity 150 %"), HasSubstr("not used"))));
  EXPECT_THAT(read(R"("temp_C": 296)").notes, Contains(HasSubstr("in kelvin it is temp_K")));
}

}  // namespace
}  // namespace forcegate
