#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "hil/base/rng.h"
#include "hil/diagnose/choose/forward_choice.h"
#include "tests/unit/diagnose/made_channel.h"

namespace forcegate::diagnose {
namespace {

// An effect whose strength differs a little from record to record, in a form of one strength and in one that has a strength for each record: that
// fits best, and foretells no record that it was not fitted to.
TEST(SimplerForm, IsTakenWhereLeftOutRecordsBearOutNoneOfManyStrengths) {
  constexpr int kRecords = 5, kRows = 400;
  constexpr std::array kStrength = {1.0, 0.9, 1.15, 0.95, 1.05};
  EffectKind effect;
  effect.name = "effect";
  effect.forms.resize(2);
  effect.forms[0].name = "of_each";
  effect.forms[1].name = "of_all";
  for (EffectForm& form : effect.forms) form.strength = {{"c", "1", -2.0, 2.0, 0.0, "share"}};
  effect.forms[0].most = 20.0;

  ResidualChannel channel = channel_of_lines(kRecords + 1, 1.0);
  channel.gain_of_unit = 1.0;
  channel.candidates = {{&effect, &effect.forms[0], {}, 0, kRecords}, {&effect, &effect.forms[1], {}, kRecords, 1}};
  channel.variants = {{0, {0, 1, 2, 3, 4}}, {1, {kRecords}}};
  Rng rng(5, "simpler form");
  for (int record = 0; record < kRecords; ++record) {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(kRows, 2 + kRecords + 2);
    for (int i = 0; i < kRows; ++i) {
      const double force = i / static_cast<double>(kRows), shape = 0.03 * std::sin(25.0 * force);
      rows(i, 0) = force;
      rows(i, 1) = 1.0;
      rows(i, 2 + record) = rows(i, 2 + kRecords) = shape;
      rows(i, rows.cols() - 1) = force + kStrength[static_cast<std::size_t>(record)] * shape + 5e-4 * rng.normal();
    }
    add_record(channel, rows, 80.0, 2.5e-7, 2.5e-7);
  }
  CampaignInput input;
  input.records.resize(kRecords);
  const ForwardChosen out = choose_forward(input, channel, {}, {}, SelectionRules{}, 1);
  ASSERT_EQ(out.selection.first.families.size(), 1u);
  EXPECT_EQ(candidate_of(channel, out.selection.first.families.front().best.variant).form->name, "of_each");
  ASSERT_EQ(out.selection.chosen.size(), 1u);
  EXPECT_EQ(candidate_of(channel, out.selection.chosen.front().variant).form->name, "of_all");
}

}  // namespace
}  // namespace forcegate::diagnose
