#include "hil/diagnose/raw/absurd_force.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(AbsurdForce, SamplesThatNoForceMadeAreLeftOutAndToldAndABlowIsNot) {
  Campaign c = make_campaign(81, straight);
  std::vector<double>& lost = c.records[1].trace.find("F_ref")->value;
  lost[700] = 1000.0, lost[701] = -4e6, lost[9000] = 1e30;
  c.records[2].trace.find("F_ref")->value[500] = 90.0;  // and the output feels it
  c.records[2].trace.find("U")->value[500] = 9.9;
  std::vector<std::string> notes;
  leave_out_absurd_force(c, 2, notes);
  EXPECT_THAT(notes, ElementsAre(testing::AllOf(HasSubstr("r1: 3 samples of F_ref left out"), HasSubstr("1e+30 N at 45 s"))));
  for (const std::size_t i : {700u, 701u, 9000u}) EXPECT_TRUE(std::isnan(lost[i])) << i;
  EXPECT_EQ(c.records[2].trace.find("F_ref")->value[500], 90.0);
}

TEST(AbsurdForce, ARecordingWithAFewIsJudgedWithoutThem) {
  for (const double far_N : {1e3, 1e6, 1e30}) {
    Campaign c = make_campaign(82, straight);
    c.records.resize(1);
    c.records[0].kind.clear();
    for (const std::size_t i : {5000u, 5001u, 5002u, 12000u}) c.records[0].trace.find("F_ref")->value[i] = far_N;
    const Diagnosis d = answer(std::move(c));
    EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << far_N << told(d);
    EXPECT_NE(told(d).find("4 samples of F_ref left out"), std::string::npos) << told(d);
    EXPECT_LT(d.force_range_N, 10.0);
  }
}

TEST(AbsurdForce, ALoggersWordForNoValueIsNoForceHoweverOftenItComes) {
  for (const std::size_t every : {50u, 7u}) {
    Campaign c = make_campaign(83, straight);
    std::vector<double>& force = c.records[0].trace.find("F_ref")->value;
    for (std::size_t i = 0; i < force.size(); i += every) force[i] = -9999.0;
    std::vector<std::string> notes;
    leave_out_absurd_force(c, 2, notes);
    EXPECT_THAT(notes, ElementsAre(testing::AllOf(HasSubstr("samples of F_ref left out"), HasSubstr("-9999 N")))) << every;
    EXPECT_TRUE(std::isnan(force[every]));
  }
}

TEST(AbsurdForce, ALoadThatTheOutputFollowsIsOneHoweverFarItIsFromTheOthers) {
  Campaign c = make_campaign(84, straight);
  std::vector<double>&force = c.records[0].trace.find("F_ref")->value, &output = c.records[0].trace.find("U")->value;
  for (std::size_t i = 0; i < force.size(); ++i) {
    force[i] = i % 5 == 0 ? 0.0 : 4.0 + 0.01 * static_cast<double>(i % 3);
    output[i] = 2.0 * force[i] + 0.2;
  }
  std::vector<std::string> notes;
  leave_out_absurd_force(c, 2, notes);
  EXPECT_TRUE(notes.empty()) << notes.front();
}

TEST(AbsurdForce, NoPhaseOfACycleIsAbsurdHoweverManyCyclesThereAre) {
  for (const double period : {12.0, 6.0, 24.0, 11.7}) {  // 24000 samples, 12 of them for one that is looked at
    Campaign c = make_campaign(85, straight);
    c.records.resize(1);
    std::vector<double>&force = c.records[0].trace.find("F_ref")->value, &output = c.records[0].trace.find("U")->value;
    for (std::size_t i = 0; i < force.size(); ++i) {
      force[i] = 1.5 + std::sin(2.0 * std::numbers::pi * static_cast<double>(i) / period) + 0.001 * static_cast<double>(i % 7);
      output[i] = 2.0 * force[i] + 8.0 * static_cast<double>(i) / static_cast<double>(force.size());
    }
    std::vector<std::string> notes;
    leave_out_absurd_force(c, 2, notes);
    EXPECT_TRUE(notes.empty()) << period << notes.front();
  }
}

}  // namespace
}  // namespace forcegate::diagnose
