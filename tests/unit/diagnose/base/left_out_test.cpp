#include "hil/diagnose/base/left_out.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/base/rng.h"
#include "tests/unit/diagnose/made_channel.h"

namespace forcegate::diagnose {
namespace {

// Records of a straight law; column 0 acts in all of them, column 1 is another noise in each.
ResidualChannel make(double strength, int records, int with_effect) {
  ResidualChannel channel = channel_of_lines(2, 0.1);
  Rng rng(31, "left out");
  for (int k = 0; k < records; ++k) {
    Eigen::MatrixXd rows(400, 5);
    const double gain = 1.0 + 0.003 * rng.normal(), own = rng.normal();
    for (int i = 0; i < 400; ++i) {
      const double F = 0.5 + 0.5 * std::sin(0.05 * i + k), x = std::sin(0.21 * i), e = 0.002 * rng.normal();
      // the second column points up or down by the record's own whim
      rows.row(i) << F, 1.0, x, std::sin(0.13 * i),
          gain * F + (k < with_effect ? strength * x : 0.0) + 0.01 * own * std::sin(0.13 * i) + e;
    }
    add_record(channel, std::move(rows), 80.0, 1e-6, 4e-6);
  }
  return channel;
}

CrossFit of_column(const ResidualChannel& channel, int column) {
  const MixedFit before = fit_mixed(channel.problem, {}, nullptr, 20, RecordUse::all_records);
  const MixedFit after = fit_mixed(channel.problem, {column}, &before, 20, RecordUse::all_records);
  EXPECT_TRUE(before.valid && after.valid);
  return cross_fit(channel, before, after);
}

TEST(CrossFit, AnEffectOfAllRecordsLowersTheErrorOfEachThatWasLeftOut) {
  const CrossFit c = of_column(make(0.02, 8, 8), 0);
  EXPECT_TRUE(c.helps());
  EXPECT_FALSE(c.blocks);
  EXPECT_EQ(c.excited, 8);
  EXPECT_EQ(c.improved, 8);
  EXPECT_GT(c.fall, 3.0 * c.standard_error);
  EXPECT_GT(c.share, 0.5);
}

TEST(CrossFit, WhatEveryRecordHasInItsOwnSizeAndSignHelpsNoOther) {
  const CrossFit c = of_column(make(0.0, 8, 0), 1);
  EXPECT_FALSE(c.helps()) << c.fall << " +- " << c.standard_error << ", " << c.improved << " of "
                          << c.excited;
}

TEST(CrossFit, RecordsWithinWhatTheInstrumentsMayLeaveHaveNoVote) {
  // three records show the effect far above the noise; the others stay below what is allowed, whatever the model does to them
  ResidualChannel channel = make(0.02, 8, 3);
  for (std::size_t k = 3; k < 8; ++k) channel.problem.records[k].allowed_variance = 1e-3;
  const CrossFit c = of_column(channel, 0);
  EXPECT_LE(c.voting, 3);
  EXPECT_EQ(c.in_favour, c.voting);
  EXPECT_TRUE(c.helps());
}

// Seven records vote; the mean square error falls by `fall` with a standard error of 1.
CrossFit of_seven(int in_favour, double fall, double log_ratio) {
  CrossFit c;
  c.excited = c.voting = 7;
  c.improved = c.in_favour = in_favour;
  c.fall = fall;
  c.standard_error = 1.0;
  c.log_ratio = log_ratio;
  return c;
}

TEST(CrossFit, AFallByOrdersOfMagnitudeOutweighsASmallRiseElsewhere) {
  CrossFit c = of_seven(3, 2.0, 1.6);
  c.fallen = 12.9;
  c.risen = 1.6;
  EXPECT_TRUE(c.helps());
  c.risen = 4.0;
  EXPECT_FALSE(c.helps()) << "what rises by a third of what falls is no small matter";
  c.risen = 1.6;
  c.in_favour = 1;
  EXPECT_FALSE(c.helps()) << "one record alone repeats nothing";
}

TEST(CrossFit, OneRecordOfALargeErrorDoesNotHideWhatTheOthersShow) {
  CrossFit c = of_seven(6, 0.95, 1.8);
  c.log_ratio_error = 0.65;
  EXPECT_TRUE(c.helps());
  c.log_ratio_error = 1.2;
  EXPECT_FALSE(c.helps());
  c.log_ratio_error = 0.65;
  c.fall = -0.95;
  EXPECT_FALSE(c.helps());
}

TEST(CrossFit, AnEffectOfTwoRecordsIsJudgedOnTheirBlocks) {
  const CrossFit c = of_column(make(0.03, 8, 2), 0);
  EXPECT_EQ(c.parts, c.blocks ? 32 : 8);
}

// A wheel on a spring whose force is bent at `from`: four records go to and fro and one turns. Beside force and zero stands the angle's own zero,
// a nuisance, which in those that do not turn looks like a bend; the effect's form is a cubic.
ResidualChannel bent_spring(double bend, double from) {
  ResidualChannel channel = channel_of_lines(2, 1.0);
  MixedProblem& p = channel.problem;
  p.nz = p.n_fixed = 3;
  p.component_of_z = {0, 1, 2};
  p.components.push_back({"angle_zero", 5e-4, 5e-4, 50.0, true, true});
  p.fixed_prior_sd = Eigen::Vector3d(10.0, 10.0, 0.03);
  Rng rng(7, "bent spring");
  for (int k = 0; k < 5; ++k) {
    const bool turns = k == 4;
    const double reach = turns ? 0.4 : 0.5;
    Eigen::MatrixXd rows(400, 6);
    for (int i = 0; i < 400; ++i) {
      const double angle = turns ? 0.31 * i : 1.66 - 1.2 * std::cos(0.05 * i + k), L = (turns ? 0.15 : 0.0) + reach * (1.0 - std::cos(angle));
      rows.row(i) << L, 1.0, reach * std::sin(angle), L * L, L * L * L, L + bend * std::max(0.0, L - from) + 1e-3 * rng.normal();
    }
    add_record(channel, std::move(rows), 80.0, 1e-6, 1e-6);
  }
  return channel;
}

TEST(CrossFit, WhatIsNobodysFindingIsToldByTheRecordThatWasLeftOutToo) {
  const ResidualChannel channel = bent_spring(0.2, 0.55);
  const MixedFit before = fit_mixed(channel.problem, {}, nullptr, 20, RecordUse::all_records);
  const CrossFit c = cross_fit(channel, before, fit_mixed(channel.problem, {0, 1}, &before, 20, RecordUse::all_records));
  EXPECT_TRUE(c.helps());
  EXPECT_EQ(c.improved, 5);
  EXPECT_GT(c.share, 0.8);
}

TEST(StrengthScatter, IsSmallForOneLawAndLargeForSomethingElse) {
  const auto scatter = [](const ResidualChannel& channel) {
    const MixedFit fit = fit_mixed(channel.problem, {0}, nullptr, 20, RecordUse::all_records);
    return strength_scatter(channel.problem, fit, {0});
  };
  EXPECT_LT(scatter(make(0.02, 8, 8)), 0.25);
  EXPECT_GT(scatter(make(0.02, 8, 4)), 0.5);
}

TEST(CrossFit, TwoModelsAreComparedAtTheSameFreedom) {
  const ResidualChannel channel = make(0.02, 6, 6);
  const MixedFit before = fit_mixed(channel.problem, {}, nullptr, 20, RecordUse::all_records);
  MixedFit stiff = before;
  stiff.variance *= 1e-6;
  const LeftOut own = leave_one_out(channel.problem, stiff),
                lent = leave_one_out(channel.problem, stiff, &before);
  for (std::size_t i = 0; i < own.adapted.size(); ++i) EXPECT_LE(lent.adapted[i], own.adapted[i]) << i;
}

}  // namespace
}  // namespace forcegate::diagnose
