// What a limit can be set on: every procedure declares the keys that it measures, and a mistyped one stops a study before it plays.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/characterize/study.h"

namespace forcegate::test {
namespace {

using namespace characterize;
using ::testing::Contains;
using ::testing::HasSubstr;

StudyPlan brief_plan() {
  StudyPlan plan = plan_of_the_paper();
  plan.specimens = {"q50"};
  plan.identification = {"q50"};
  plan.exemplar.clear();
  plan.sessions = 1;
  plan.record_s = 120.0;
  plan.recovery_s = {30.0, 60.0};
  return plan;
}

TEST(LimitKeys, EveryMeasurementOfAProcedureIsDeclared) {
  for (const char* sensor : {"flexiforce", "fsr"}) {
    StudyPlan plan = brief_plan();
    auto& listed = std::string_view(sensor) == "fsr" ? plan.fsr : plan.flexiforce;
    std::vector<std::string> keys;
    for (const std::string& name : listed)
      for (std::string& key : Registry<ProcedureKind>::instance().find(name)->keys(plan, sensor)) keys.push_back(std::move(key));
    const auto studies = run(request_of(plan, {sensor}));
    ASSERT_FALSE(studies[0].sheets[0].failure) << studies[0].sheets[0].failure->text;
    EXPECT_FALSE(studies[0].sheets[0].values.empty());
    for (const Measurement& m : studies[0].sheets[0].values) EXPECT_THAT(keys, Contains(m.key)) << sensor;
    EXPECT_EQ(keys.size(), studies[0].sheets[0].values.size()) << sensor;
  }
}

TEST(LimitKeys, AKeyThatNobodyMeasuresStopsTheStudyBeforeItPlays) {
  StudyPlan plan = brief_plan();
  plan.flexiforce = {"static_calibration"};
  plan.limits = {{"static.linearity", 0.0, 1.0, "x"}};
  EXPECT_TRUE(check_limit_keys(plan, {"flexiforce"}));
  plan.limits.push_back({"static.linearty", 0.0, 1.0, "x", "p.toml:19:1"});
  const auto misspelt = check_limit_keys(plan, {"flexiforce"});
  ASSERT_FALSE(misspelt);
  EXPECT_EQ(misspelt.error().code, ErrorCode::config);
  EXPECT_EQ(misspelt.error().where, "p.toml:19:1");
  EXPECT_THAT(misspelt.error().hint, HasSubstr("did you mean \"static.linearity\"?"));
  plan.limits.back().key = "hysteresis of mine";
  EXPECT_THAT(check_limit_keys(plan, {"flexiforce"}).error().hint, HasSubstr("measure static.gain, static.offset, "));
}

TEST(LimitKeys, AKeyOfAProcedureThatIsNotPlayedIsToldWithIt) {
  StudyPlan plan = brief_plan();
  plan.flexiforce = {"static_calibration"};
  plan.fsr = {"static_calibration", "force_control"};
  plan.limits = {{"control.identified_maxima", 0.0, 1.0, "x"}};
  EXPECT_THAT(check_limit_keys(plan, {"flexiforce", "fsr"}).error().hint, HasSubstr("measured by force_control of flexiforce"));
  plan.limits = {{"control.raw_maxima", 0.0, 1.0, "x"}};
  EXPECT_TRUE(check_limit_keys(plan, {"flexiforce", "fsr"}));
  EXPECT_FALSE(check_limit_keys(plan, {"flexiforce"}));
}

TEST(LimitKeys, AMisspeltMaximumIsToldBeforeTheLimitThatLacksIt) {
  const auto read = [](const std::string& line) {
    return parse_study_plan("format = 1\nkind = \"characterize\"\nname = \"x\"\n[population]\nspecimens = [\"q50\"]\nsessions = 1\n[procedures]\nflexiforce = "
                            "[\"static_calibration\"]\n[[limit]]\n" + line + "key = \"static.gain\"\nsource = \"x\"\n", "p.toml");
  };
  const auto misspelt = read("maximun = 1\n"), none = read("");
  ASSERT_FALSE(misspelt);
  EXPECT_EQ(misspelt.error().where, "p.toml:10:1");
  EXPECT_THAT(misspelt.error().hint, HasSubstr("did you mean 'maximum'?"));
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().hint, HasSubstr("add one"));
}

TEST(LimitKeys, APlanTellsWhereTheKeyStands) {
  const StudyPlan plan = value_or_abort(parse_study_plan(
      "format = 1\nkind = \"characterize\"\nname = \"x\"\n[population]\nspecimens = [\"q50\"]\nsessions = 1\n[procedures]\nflexiforce = "
      "[\"static_calibration\"]\n[[limit]]\nmaximum = 1\nkey = \"static.gian\"\nsource = \"x\"\n",
      "p.toml"));
  EXPECT_THAT(check_limit_keys(plan, {"flexiforce"}).error().where, HasSubstr("p.toml:11"));
}

}  // namespace
}  // namespace forcegate::test
