#include "hil/diagnose/between/record_regression.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/base/rng.h"
#include "hil/diagnose/between/record_chance.h"

namespace forcegate::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const std::vector<double> kSizes = {0.003, 0.01, 0.03, 0.1};

// Ten records; some of them know their value to a third of the scatter only.
RecordSeries scatter(Rng& rng, Index n = 10, double sd = 0.005) {
  RecordSeries out;
  out.value.resize(n);
  out.variance.resize(n);
  for (Index i = 0; i < n; ++i) {
    const double u = i % 3 == 0 ? 0.3 * sd : 0.02 * sd;
    out.variance[i] = u * u;
    out.value[i] = sd * rng.normal() + u * rng.normal();
  }
  return out;
}

RecordPredictor one_column(Rng& rng, Index n = 10) {
  RecordPredictor p{MatrixXd(n, 1), VectorXd::Ones(1)};
  for (Index i = 0; i < n; ++i) p.column(i, 0) = rng.normal();
  normalise(p);
  return p;
}

TEST(RecordRegression, TheChanceIsUniformWhereNothingActs) {
  Rng rng(11, "null");
  int below_1 = 0, below_10 = 0, below_50 = 0;
  constexpr int kCampaigns = 400;
  for (int k = 0; k < kCampaigns; ++k) {
    const RecordSeries s = scatter(rng);
    const double p = chance_of_records({{s, {one_column(rng), one_column(rng)}}}, 99, 5).of_orders;
    below_1 += p <= 0.01 ? 1 : 0;
    below_10 += p <= 0.10 ? 1 : 0;
    below_50 += p <= 0.50 ? 1 : 0;
  }
  // three standard errors of a binomial
  EXPECT_LE(below_1, 10);
  EXPECT_NEAR(below_10, 40, 18);
  EXPECT_NEAR(below_50, 200, 30);
}

TEST(RecordRegression, FiveRecordsHaveFewOrdersButManyDirections) {
  Rng rng(15, "five");
  for (int k = 0; k < 20; ++k) {
    RecordSeries s = scatter(rng, 5);
    const RecordPredictor p = one_column(rng, 5);
    s.value += 0.3 * p.column.col(0);
    const RecordChance chance = chance_of_records({{s, {p}}}, 1999, 3);
    EXPECT_GT(chance.of_orders, 1.0 / 240.0);  // 5! orders
    EXPECT_LT(chance.of_directions, 0.003);
  }
}

TEST(RecordRegression, DirectionsTellChanceWhereNothingActs) {
  Rng rng(17, "null of five");
  int below_1 = 0;
  constexpr int kCampaigns = 1000;
  for (int k = 0; k < kCampaigns; ++k) {
    RecordSeries s = scatter(rng, 5);
    s.variance.setZero();
    below_1 += chance_of_records({{s, {one_column(rng, 5)}}}, 499, 7).of_directions <= 0.01 ? 1 : 0;
  }
  EXPECT_LE(below_1, 20);
}

TEST(RecordRegression, TheScoreHardlyEverReachesFiveWhereNothingActs) {
  Rng rng(12, "null");
  int reached = 0;
  for (int k = 0; k < 400; ++k)
    reached += score_predictors(scatter(rng), {one_column(rng)}, kSizes).front().gain >= 5.0 ? 1 : 0;
  // a Bayes factor of e^5 has a chance of at most e^-5 = 0.7 %
  EXPECT_LE(reached, 8);
}

TEST(RecordRegression, AnEffectOfFourTimesTheScatterIsSeenInTenRecords) {
  Rng rng(13, "effect");
  int seen = 0;
  for (int k = 0; k < 40; ++k) {
    RecordSeries s = scatter(rng);
    const RecordPredictor p = one_column(rng);
    s.value += 0.02 * p.column.col(0);
    const RecordScore score = score_predictors(s, {p}, kSizes).front();
    seen += score.gain > 5.0 && score.explained > 0.75 && score.left_out < 0.5 && chance_of_records({{s, {p}}}, 499, 1).of_orders <= 0.01 ? 1 : 0;
    EXPECT_NEAR(std::sqrt(score.added.squaredNorm() / 10.0), 0.02, 0.007);
  }
  EXPECT_GE(seen, 38);
}

TEST(RecordRegression, TheOrderOfTheRecordsDoesNotMatter) {
  Rng rng(14, "order");
  RecordSeries s = scatter(rng);
  RecordPredictor p = one_column(rng);
  s.value += 0.01 * p.column.col(0);
  const RecordScore before = score_predictors(s, {p}, kSizes).front();
  s.value.reverseInPlace();
  s.variance.reverseInPlace();
  p.column.col(0).reverseInPlace();
  const RecordScore after = score_predictors(s, {p}, kSizes).front();
  EXPECT_NEAR(before.gain, after.gain, 1e-9);
  EXPECT_NEAR(before.explained, after.explained, 1e-9);
  EXPECT_NEAR(before.left_out, after.left_out, 1e-9);
}

TEST(RecordRegression, WhatOnlyTellsTheSessionsApartIsNoEvidence) {
  Rng rng(15, "session");
  RecordSeries s = scatter(rng, 10, 0.001);
  RecordPredictor step{MatrixXd::Zero(10, 1), VectorXd::Ones(1)};
  for (Index i = 5; i < 10; ++i) {
    s.value[i] += 0.02;
    step.column(i, 0) = 1.0;
  }
  normalise(step);
  EXPECT_GT(score_predictors(s, {step}, kSizes).front().gain, 5.0);
  s.session = {0, 0, 0, 0, 0, 1, 1, 1, 1, 1};
  EXPECT_LT(score_predictors(s, {step}, kSizes).front().gain, 3.0);
}

// Two or three records in each of five sessions: the records of one agree within a tenth of what the sessions differ by.
constexpr Index kOfSessions = 12;

RecordSeries five_sessions(Rng& rng, double sd) {
  RecordSeries out;
  out.session = {0, 0, 0, 1, 1, 2, 2, 3, 3, 3, 4, 4};
  out.value.resize(kOfSessions);
  out.variance = VectorXd::Constant(kOfSessions, 1e-4 * sd * sd);
  for (Index i = 0; i < kOfSessions; ++i) out.value[i] = sd * rng.normal();
  return out;
}

// What is the same in all records of a session.
VectorXd by_session(Rng& rng, const RecordSeries& series) {
  const VectorXd of = VectorXd::NullaryExpr(5, [&](Index) { return rng.normal(); });
  return VectorXd::NullaryExpr(kOfSessions, [&](Index i) { return of[series.session[static_cast<std::size_t>(i)]]; });
}

// Without x the spread is that of the sessions, and the scatter within them would not fall at all.
TEST(RecordRegression, WhatTheSessionsHeldWithoutAPredictorIsExplainedByIt) {
  Rng rng(31, "sessions");
  for (int k = 0; k < 20; ++k) {
    RecordSeries s = five_sessions(rng, 0.001);
    RecordPredictor p{MatrixXd(by_session(rng, s)), VectorXd::Ones(1)};
    normalise(p);
    s.value += 0.01 * p.column.col(0);
    const RecordScore score = score_predictors(s, {p}, kSizes).front();
    EXPECT_GT(score.explained, 0.9) << k;
    EXPECT_LT(chance_of_records({{s, {p}}}, 499, 1).of_orders, 0.02) << k;
  }
}

TEST(RecordRegression, SessionsThatDifferByTenTimesTheScatterMakeNoChanceSmall) {
  Rng rng(37, "null of sessions");
  int below_2 = 0;
  constexpr int kCampaigns = 400;
  for (int k = 0; k < kCampaigns; ++k) {
    RecordSeries s = five_sessions(rng, 0.001);
    s.value += 0.01 * by_session(rng, s);
    RecordPredictor p{MatrixXd(by_session(rng, s)), VectorXd::Ones(1)};
    normalise(p);
    below_2 += chance_of_records({{s, {p}}}, 199, 5).of_orders < 0.02 ? 1 : 0;
  }
  EXPECT_LE(below_2, 14);
}

TEST(RecordRegression, AColumnThatIsTheSameForAllRecordsAsksNothing) {
  RecordPredictor p{MatrixXd::Constant(8, 1, 3.0), VectorXd::Ones(1)};
  EXPECT_EQ(normalise(p), 0.0);
}

TEST(RecordRegression, ThreeRecordsHaveNoScore) {
  Rng rng(16, "few");
  const RecordScore score = score_predictors(scatter(rng, 3), {one_column(rng, 3)}, kSizes).front();
  EXPECT_LT(score.gain, -1e299);
  EXPECT_EQ(chance_of_records({{scatter(rng, 3), {one_column(rng, 3)}}}, 99, 1).of_orders, 1.0);
}

TEST(RecordRegression, TheBoundOfABayesFactorIsThatOfItsChance) {
  // Sellke, Bayarri and Berger 2001, table 1: p = 0.05, 0.01, 0.001 leave odds of 2.5, 8.1 and 53
  EXPECT_NEAR(bayes_factor_bound(0.05), 2.46, 0.01);
  EXPECT_NEAR(bayes_factor_bound(0.01), 7.99, 0.01);
  EXPECT_NEAR(bayes_factor_bound(0.001), 53.3, 0.1);
  EXPECT_EQ(bayes_factor_bound(0.5), 1.0);
}

TEST(RecordRegression, FewRecordsThatFitTooWellAreChance) {
  // five records on a line to a part in ten thousand: no specimen repeats like that
  RecordSeries s;
  s.value = VectorXd::LinSpaced(5, -0.004, 0.004);
  s.variance = VectorXd::Constant(5, 1e-10);
  RecordPredictor p{MatrixXd(VectorXd::LinSpaced(5, -1.0, 1.0)), VectorXd::Ones(1)};
  normalise(p);
  EXPECT_LT(score_predictors(s, {p}, kSizes).front().gain, 4.0);
  s.typical_scatter = 2e-4;
  EXPECT_GT(score_predictors(s, {p}, kSizes).front().gain, 5.0);
}

// Seven quasi-static records follow a predictor; three cyclic ones are known to a tenth of what they are off by.
TEST(RecordRegression, CyclicRecordsThatScatterMoreDoNotHideWhatTheOthersShow) {
  Rng rng(23, "cyclic");
  constexpr Index kRecords = 10, kStatic = 7;
  double with = 0.0, without = 0.0;
  for (int k = 0; k < 10; ++k) {
    RecordSeries s = scatter(rng, kRecords, 0.002);
    const RecordPredictor p = one_column(rng, kRecords);
    s.value += 0.01 * p.column.col(0);
    for (Index i = kStatic; i < kRecords; ++i) s.value[i] += 0.03 * rng.normal();
    without += score_predictors(s, {p}, kSizes)[0].gain;
    s.cyclic = {0, 0, 0, 0, 0, 0, 0, 1, 1, 1};
    with += score_predictors(s, {p}, kSizes)[0].gain;
  }
  EXPECT_GT(with, without + 20.0);
}

TEST(RecordRegression, NamingRecordsCyclicMakesNoEvidenceWhereNothingActs) {
  Rng rng(29, "cyclic null");
  int claims = 0;
  for (int k = 0; k < 300; ++k) {
    RecordSeries s = scatter(rng);
    s.cyclic = {1, 0, 0, 1, 0, 0, 0, 1, 0, 0};
    for (const Index i : {0, 3, 7}) s.value[i] += 0.03 * rng.normal();
    claims += score_predictors(s, {one_column(rng)}, kSizes)[0].gain > 3.0 ? 1 : 0;
  }
  EXPECT_LE(claims, 4);
}

}  // namespace
}  // namespace forcegate::diagnose
