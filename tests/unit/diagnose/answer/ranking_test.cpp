// What only one effect explains, beside what it explains alone.

#include <algorithm>

#include "tests/unit/diagnose/creeping_campaign.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

TEST(Ranking, WhatNoOtherEffectExplainsIsOfTheClaimAlone) {
  const Diagnosis d = answer(creeping(1));
  ASSERT_GE(probability(d, "creep"), 0.9) << told(d);
  const auto creep = std::ranges::find(d.ranking, "creep", &RankedEffect::effect);
  ASSERT_NE(creep, d.ranking.end());
  EXPECT_GT(creep->alone, 0.5);
  EXPECT_GT(creep->unique, 0.3);
}

}  // namespace
}  // namespace forcegate::diagnose
