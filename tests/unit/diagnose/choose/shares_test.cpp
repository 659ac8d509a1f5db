#include "hil/diagnose/choose/shares.h"

#include <gtest/gtest.h>

#include <cmath>

namespace forcegate::diagnose {
namespace {

// A cause between records that was chosen, and one rival of it.
struct Shared {
  EffectKind cause, rival;
  ResidualChannel channel;
  ScreenResult result;
  ChosenEffect chosen;
  SelectionRules rules;

  Shared() {
    cause.name = "thermal", rival.name = "reference_drift";
    cause.traits.between_records = rival.traits.between_records = true;
    for (EffectKind* kind : {&cause, &rival}) {
      kind->forms.emplace_back().name = "a form";
      channel.candidates.push_back({kind, &kind->forms[0], {}, 0, 1});
      channel.variants.push_back({static_cast<int>(channel.variants.size()), {0}});
      FamilyScore& family = result.families.emplace_back();
      family.kind = kind;
      family.best.variant = family.records.variant = static_cast<int>(result.families.size()) - 1;
      family.records.valid = true;
      family.gain = family.records.gain = kind == &cause ? 6.0 : 5.0;
    }
  }

  double share_of_chosen(std::size_t place = 0) {
    chosen = {};
    chosen.kind = result.families[place].kind;
    chosen.variant = static_cast<int>(place);
    chosen.between = true;
    chosen.gain = result.families[place].gain;
    chosen.records = result.families[place].records;
    set_shares(channel, result, place, rules, false, chosen);
    return chosen.share_of_family;
  }
};

TEST(Shares, LevelsAreWeighedByTheirEvidence) {
  Shared s;
  EXPECT_NEAR(s.share_of_chosen(), 1.0 / (1.0 + std::exp(-1.0)), 1e-12);
}

TEST(Shares, ACauseThatNobodyRecordedCountsForLess) {
  Shared s;
  s.result.families[1].records.prior = -std::log(4.0);
  EXPECT_NEAR(s.share_of_chosen(), 1.0 / (1.0 + 0.25 * std::exp(-1.0)), 1e-12);
}

TEST(Shares, RowsThatFollowTheCauseWithinTheRecordsCountToo) {
  Shared s;
  const double without = s.share_of_chosen();
  s.result.families[0].records.within = 60.0;
  EXPECT_GT(s.share_of_chosen(), without + 0.2);
  // less than any effect within records needs says nothing
  s.result.families[0].records.within = 10.0;
  EXPECT_EQ(s.share_of_chosen(), without);
}

// Turned down for what its rows show, and never asked for its levels.
TEST(Shares, WhatWasTurnedDownForItsRowsIsARivalOfWhatLevelsChose) {
  Shared s;
  s.result.families[0].gain = s.result.families[0].records.within = 110.0;
  EXPECT_LT(s.share_of_chosen(1), 0.1);
  ASSERT_EQ(s.chosen.rivals.size(), 1U);
  EXPECT_EQ(s.chosen.rivals[0].first, "thermal");
  // that of the levels themselves was
  s.result.families[0].gain = 6.0;
  EXPECT_EQ(s.share_of_chosen(1), 1.0);
}

TEST(Shares, WhatOutlastsARecordDoesNotGoWithWhatWasRecordedOfThem) {
  Shared s;
  s.rival.traits.between_records = false;
  s.rival.look_alikes = s.cause.look_alikes = {};
  s.cause.look_alikes = {s.rival.name};
  s.result.families[1].records = {};
  s.result.families[1].gain = 200.0;
  s.result.families[0].gain = 220.0;
  EXPECT_NEAR(s.share_of_chosen(), 0.5, 1e-12);
  s.cause.forms[0].cause.of_record = [](const RecordInput&) { return 20.0; };
  EXPECT_NEAR(s.share_of_chosen(), 1.0 / (1.0 + std::exp(-6.0)), 1e-12);
}

TEST(Shares, WhatRowsAndLevelsTellAlikeIsNotSharedWithWhatMovesNoLevels) {
  Shared s;
  s.rival.traits.between_records = false;
  s.cause.look_alikes = {s.rival.name};
  s.result.families[1].records = {};
  s.result.families[1].gain = 200.0;
  s.result.families[0].gain = 220.0;
  s.result.families[0].records.same_strength = true;
  EXPECT_NEAR(s.share_of_chosen(), 1.0 / (1.0 + std::exp(-6.0)), 1e-12);
}

TEST(Shares, WhatStandsInForALookAlikeSharesItsPlaceWithIt) {
  Shared s;
  s.cause.look_alikes = {s.rival.name};
  s.result.families.pop_back();
  Selection selection;
  ASSERT_EQ(s.share_of_chosen(), 1.0);
  selection.chosen = {s.chosen};
  ChosenEffect idle;
  idle.kind = &s.rival;
  idle.between = true;
  idle.gain = 7.0;
  share_with_idle({idle}, selection);
  EXPECT_NEAR(selection.chosen[0].share_of_family, 1.0 / (1.0 + std::exp(1.0)), 1e-12);
  ASSERT_EQ(selection.chosen[0].rivals.size(), 1U);
  EXPECT_EQ(selection.chosen[0].rivals[0].first, s.rival.name);

  // of rows at the temperature of rows
  selection.chosen = {s.chosen};
  selection.chosen[0].not_by_records = Refusal::too_little_evidence;
  selection.chosen[0].gain = 200.0;
  idle.gain = 188.0;
  share_with_idle({idle}, selection);
  EXPECT_NEAR(selection.chosen[0].share_of_family, 1.0 / (1.0 + std::exp(-1.0)), 1e-12);

  // held-out records do decide between what acts within them
  idle.between = false;
  selection.chosen = {s.chosen};
  share_with_idle({idle}, selection);
  EXPECT_EQ(selection.chosen[0].share_of_family, 1.0);
}

}  // namespace
}  // namespace forcegate::diagnose
