#include "hil/diagnose/choose/needless.h"

#include "tests/unit/diagnose/chosen_by_hand.h"

namespace forcegate::diagnose {
namespace {

using Needless = ChosenByHand;

bool has_any(const std::vector<int>& columns, const std::vector<int>& of) {
  return std::any_of(of.begin(), of.end(), [&](int j) { return std::find(columns.begin(), columns.end(), j) != columns.end(); });
}

TEST_F(Needless, ACompromiseGoesOnceTheEffectThatItStoodForIsIn) {
  selection_.chosen = {taken("delay", 0.6, "lag"), taken("lag", 1.0, ""), taken("hysteresis", 1.0, "")};
  const std::vector<int> gone = selection_.chosen[0].columns;
  selection_.final = fit_mixed(w_->output.problem, gone, nullptr, 20, RecordUse::all_records);
  drop_needless(w_->output, {}, rules_, selection_);
  ASSERT_EQ(selection_.chosen.size(), 2u);
  EXPECT_EQ(selection_.chosen[0].kind->name, "lag");
  EXPECT_EQ(selection_.chosen[1].kind->name, "hysteresis");
  ASSERT_EQ(selection_.refused.size(), 1u);
  EXPECT_EQ(selection_.refused[0].effect, "delay");
  EXPECT_EQ(selection_.refused[0].reason, Refusal::needless);
  EXPECT_FALSE(has_any(selection_.final.columns, gone)) << "the model is fitted anew";
  EXPECT_FALSE(has_any(selection_.chosen[1].fit.columns, gone));
  EXPECT_TRUE(has_any(selection_.chosen[1].fit.columns, selection_.chosen[0].columns));
}

TEST_F(Needless, WhatTheOthersCannotDoWithoutStaysWithTheEvidenceThatOnlyItHas) {
  selection_.chosen = {taken("lag", 1.0, ""), taken("hysteresis", 1.0, "")};
  drop_needless(w_->output, {}, rules_, selection_);
  ASSERT_EQ(selection_.chosen.size(), 2u);
  EXPECT_TRUE(selection_.refused.empty());
  for (const ChosenEffect& chosen : selection_.chosen) EXPECT_GT(chosen.unique, rules_.first_gain) << chosen.kind->name;
}

TEST_F(Needless, WhatIsCarriedAlongMakesAnEffectNeedlessToo) {
  selection_.chosen = {taken("delay", 0.6, "lag"), taken("hysteresis", 1.0, "")};
  drop_needless(w_->output, taken("lag", 1.0, "").columns, rules_, selection_);
  ASSERT_EQ(selection_.chosen.size(), 1u);
  EXPECT_EQ(selection_.chosen[0].kind->name, "hysteresis");
}

// A curve, a growth, a few milliseconds, and a play that the held-out records show the other way round: the loop comes up, and the curve
// with a growth does without it.
TEST(DropNeedless, TheSearchTellsWhatItDoesWithout) {
  const Diagnosis d = answer(make_campaign(2, [](const std::vector<double>& t, const std::vector<double>& F, int record) {
    constexpr std::size_t kLate = 2;
    const double share = record == 3 || record == 6 ? -0.022 : 0.022;
    std::vector<double> U;
    double slow = 0.0, play = 0.0;
    for (std::size_t i = 0; i < F.size(); ++i) {
      slow += (F[i] - slow) * -std::expm1(-(i == 0 ? 0.0 : t[i] - t[i - 1]) / 40.0);
      play = std::min(std::max(play, F[i] - 0.4), F[i] + 0.4);
      U.push_back(2.0 * (std::tanh(0.096 * (F[i < kLate ? 0 : i - kLate] + 0.03 * slow)) / 0.096 + share * play) + 0.2);
    }
    return U;
  }));
  EXPECT_TRUE(std::any_of(d.refused.begin(), d.refused.end(), [](const RefusedEffect& r) {
    return r.effect == "hysteresis" && r.reason == Refusal::needless;
  })) << told(d);
  EXPECT_LT(probability(d, "hysteresis"), 0.5) << told(d);
  EXPECT_GT(probability(d, "static_nonlinearity"), 0.5) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
