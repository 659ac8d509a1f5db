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

}  // namespace
}  // namespace forcegate
