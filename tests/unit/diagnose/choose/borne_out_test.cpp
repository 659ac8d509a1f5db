#include "hil/diagnose/choose/borne_out.h"

#include "tests/unit/diagnose/chosen_by_hand.h"

namespace forcegate::diagnose {
namespace {

using BorneOut = ChosenByHand;

TEST_F(BorneOut, WhatIsThereLowersTheErrorOfHeldOutRecords) {
  selection_.chosen = {taken("lag", 1.0, "")};
  measure_left_out(*w_, w_->output, selection_);
  EXPECT_TRUE(selection_.chosen[0].borne_out);
  EXPECT_LT(selection_.chosen[0].error_after, 0.7 * selection_.chosen[0].error_before);
  EXPECT_TRUE(not_borne_out(w_->output, selection_).empty());
}

TEST_F(BorneOut, WhatIsNotThereIsASuspicionBelowEvenOdds) {
  ChosenEffect curve = taken("static_nonlinearity", 0.9, "");
  // what the fit records give it by chance, many times over
  curve.fit.coefficient.tail(static_cast<Eigen::Index>(curve.fit.columns.size())).setConstant(0.2);
  selection_.chosen = {curve};
  measure_left_out(*w_, w_->output, selection_);
  EXPECT_FALSE(selection_.chosen[0].borne_out) << selection_.chosen[0].error_before << " " << selection_.chosen[0].error_after;
  const auto idle = not_borne_out(w_->output, selection_);
  ASSERT_EQ(idle.size(), 1u);
  EXPECT_EQ(idle[0].effect, "static_nonlinearity");
  EXPECT_LT(idle[0].probability, 0.5);
}

TEST_F(BorneOut, WhatFewFitRecordsGetWrongIsAskedOfAllRecords) {
  ChosenEffect lag = taken("lag", 1.0, "");
  lag.fit.coefficient.tail(static_cast<Eigen::Index>(lag.fit.columns.size())) *= -1.0;
  selection_.chosen = {lag};
  measure_left_out(*w_, w_->output, selection_);
  EXPECT_TRUE(selection_.chosen[0].borne_out) << "each record alone, from all others, is told by the lag";
  EXPECT_LT(selection_.chosen[0].error_after, 0.7 * selection_.chosen[0].error_before);
}

TEST_F(BorneOut, AStandInMustLowerTheError) {
  // as much of a creep as leaves the held-out records where they were
  const ChosenEffect whole = taken("creep", 1.0, "");
  const auto n = static_cast<Eigen::Index>(whole.fit.columns.size());
  double low = 0.2, high = 0.5;
  for (int step = 0; step < 20; ++step) {
    ChosenEffect creep = whole;
    creep.fit.coefficient.tail(n) *= 0.5 * (low + high);
    selection_.chosen = {creep};
    measure_left_out(*w_, w_->output, selection_);
    (selection_.chosen[0].error_after > 1.005 * selection_.chosen[0].error_before ? low : high) = 0.5 * (low + high);
  }
  EXPECT_NEAR(selection_.chosen[0].error_after / selection_.chosen[0].error_before, 1.005, 1e-3);
  EXPECT_TRUE(selection_.chosen[0].borne_out) << "an effect of a few held-out records may leave their mean as it was";
  measure_left_out(*w_, w_->output, selection_, true);
  EXPECT_FALSE(selection_.chosen[0].borne_out);
}

}  // namespace
}  // namespace forcegate::diagnose
