#include "hil/app/league/league_stage.h"

#include <gtest/gtest.h>

namespace forcegate {
namespace {

MissStage of_missed(const std::string& effect) {
  LeagueMatch m;
  m.kind = LeagueClass::single;
  m.truth.effects.emplace_back();
  m.truth.effects[0].name = effect;
  m.truth.effects[0].excited = true;
  m.answer.verdict = "none";
  return miss_of(m).stage;
}

TEST(LeagueStage, WhatADetectorFindsInTheSamplesWasMissedByIt) {
  for (const char* effect : {"adc_codes", "clipping", "dropouts", "hum", "outliers", "reference_noise"}) EXPECT_EQ(of_missed(effect), MissStage::raw_health) << effect;
  EXPECT_EQ(of_missed("creep"), MissStage::not_a_candidate);
}

TEST(LeagueStage, WhatIsListedWhereNothingIsClaimedWasBeatenByNoOther) {
  LeagueMatch m;
  m.kind = LeagueClass::single;
  m.truth.effects.emplace_back();
  m.truth.effects[0].name = "wear";
  m.truth.effects[0].excited = true;
  m.answer.verdict = "none";
  m.answer.findings = {{"wear", "sensor", 0.49, {}}, {"delay", "instrument", 0.08, {}}};
  EXPECT_EQ(miss_of(m).stage, MissStage::not_claimed);
  EXPECT_EQ(miss_of(m).other, "");
  m.answer.findings.insert(m.answer.findings.begin(), {"creep", "sensor", 0.9, {}});
  EXPECT_EQ(miss_of(m).stage, MissStage::outclaimed);
  EXPECT_EQ(miss_of(m).other, "creep");
}

}  // namespace
}  // namespace forcegate
