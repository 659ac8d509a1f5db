#include "hil/diagnose/choose/reconsider.h"

#include "tests/unit/diagnose/chosen_by_hand.h"

namespace forcegate::diagnose {
namespace {

using Reconsidered = ChosenByHand;

TEST_F(Reconsidered, ARivalThatExplainsMoreBesideTheOthersTakesThePlace) {
  selection_.chosen = {taken("delay", 0.6, "lag"), taken("hysteresis", 1.0, "")};
  reconsider(w_->input, w_->output, {}, {}, rules_, 1, selection_);
  ASSERT_EQ(selection_.chosen.size(), 2u);
  EXPECT_EQ(selection_.chosen[0].kind->name, "lag");
  EXPECT_GT(selection_.chosen[0].share_of_family, 0.9);
  EXPECT_EQ(selection_.chosen[1].kind->name, "hysteresis");
}

TEST_F(Reconsidered, AnEffectThatKeepsItsPlaceIsSurerAndKeepsWhatItEnteredWith) {
  selection_.chosen = {taken("lag", 0.6, "delay"), taken("hysteresis", 1.0, "")};
  const double gain = selection_.chosen[0].gain, fall = selection_.chosen[0].fall;
  reconsider(w_->input, w_->output, {}, {}, rules_, 1, selection_);
  EXPECT_EQ(selection_.chosen[0].kind->name, "lag");
  EXPECT_GT(selection_.chosen[0].share_of_family, 0.9);
  EXPECT_DOUBLE_EQ(selection_.chosen[0].gain, gain);
  EXPECT_DOUBLE_EQ(selection_.chosen[0].fall, fall);
}

TEST_F(Reconsidered, ARivalThatSomethingSpeaksAgainstDoesNot) {
  rules_.later_gain = 1e9;
  selection_.chosen = {taken("delay", 0.6, "lag"), taken("hysteresis", 1.0, "")};
  reconsider(w_->input, w_->output, {}, {}, rules_, 1, selection_);
  EXPECT_EQ(selection_.chosen[0].kind->name, "delay");
}

TEST_F(Reconsidered, WhatHadNoRivalIsNotAskedAgain) {
  selection_.chosen = {taken("delay", 0.97, "lag"), taken("hysteresis", 1.0, "")};
  reconsider(w_->input, w_->output, {}, {}, rules_, 1, selection_);
  EXPECT_EQ(selection_.chosen[0].kind->name, "delay");
  EXPECT_DOUBLE_EQ(selection_.chosen[0].share_of_family, 0.97);
}

TEST_F(Reconsidered, AnEffectAloneStandsBesideNothingNew) {
  selection_.chosen = {taken("delay", 0.6, "lag")};
  reconsider(w_->input, w_->output, {}, {}, rules_, 1, selection_);
  EXPECT_EQ(selection_.chosen[0].kind->name, "delay");
}

TEST_F(Reconsidered, OnlyItsOwnRivalsAreAsked) {
  selection_.chosen = {taken("delay", 0.6, "rc"), taken("hysteresis", 1.0, "")};
  reconsider(w_->input, w_->output, {}, {}, rules_, 1, selection_);
  EXPECT_NE(selection_.chosen[0].kind->name, "lag");
}

// A lag before a curve that saturates: whichever is taken first shares its probability while the other is still in the residual.
TEST(Reconsider, BothOfTwoEffectsAreSureOnceEachStandsBesideTheOther) {
  const Diagnosis d = answer(make_campaign(1, [](const std::vector<double>& t, const std::vector<double>& F, int) {
    std::vector<double> U;
    double slow = F[0];
    for (std::size_t i = 0; i < F.size(); ++i) {
      slow += (F[i] - slow) * -std::expm1(-(i == 0 ? 0.0 : t[i] - t[i - 1]) / 0.1);
      U.push_back(9.0 * std::tanh(slow / 6.0) + 0.2);
    }
    return U;
  }));
  for (const char* effect : {"lag", "static_nonlinearity"}) EXPECT_GT(probability(d, effect), 0.9) << effect << "\n" << told(d);
}

TEST_F(Reconsidered, TheModelThatIsLeftIsOfTheEffectsThatAreChosenThen) {
  selection_.chosen = {taken("delay", 0.6, "lag"), taken("hysteresis", 1.0, "")};
  selection_.final = fit_mixed(w_->output.problem, selection_.chosen[0].columns, nullptr, 20, RecordUse::all_records);
  const std::vector<int> gone = selection_.chosen[0].columns;
  reconsider(w_->input, w_->output, {}, {}, rules_, 1, selection_);
  const auto stands = [&](int j) { return std::ranges::find(selection_.final.columns, j) != selection_.final.columns.end(); };
  for (const ChosenEffect& chosen : selection_.chosen)
    for (const int j : chosen.columns) EXPECT_TRUE(stands(j)) << chosen.kind->name;
  for (const int j : gone) EXPECT_FALSE(stands(j)) << "of the delay that gave way";
}

}  // namespace
}  // namespace forcegate::diagnose
