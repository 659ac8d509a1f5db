#include <gtest/gtest.h>

#include <cmath>

#include "hil/base/rng.h"
#include "hil/diagnose/base/judge.h"
#include "hil/diagnose/base/some_columns.h"
#include "hil/diagnose/between/between_records.h"
#include "tests/unit/diagnose/made_channel.h"

namespace forcegate::diagnose {
namespace {

constexpr int kRecords = 8;
constexpr double kNoise = 1e-3, kStrength = 0.4, kGainSd = 0.05;
enum { kEffect, kCause };  // columns of S

struct Made {
  ResidualChannel channel;
  std::vector<double> gain, cause;
};

// A sensor whose output is gain (F + 0.4 effect), with a gain that is the record's own and follows a cause that was recorded.
Made make(GrowsWithGain effect, double per_cause, bool effect_grows = true) {
  Made out{channel_of_lines(2, 1.0), {}, {}};
  out.channel.problem.grows_with_gain = {effect, GrowsWithGain::is_gain};
  Rng rng(21, "gain");
  for (int k = 0; k < kRecords; ++k) {
    out.gain.push_back(kGainSd * rng.normal());
    out.cause.push_back(k % 2 == 0 ? -1.0 + 0.1 * k : 1.0 - 0.2 * k / kRecords);
    Eigen::MatrixXd A(600, 5);
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      const double phase = 0.05 * static_cast<double>(i) + k, F = 0.5 + 0.5 * std::sin(phase), s = std::sin(2.0 * phase);
      const double of_all = 1.0 + out.gain.back() + per_cause * out.cause.back();
      A.row(i) << F, 1.0, s, out.cause.back() * F, of_all * F + (effect_grows ? of_all : 1.0) * kStrength * s + kNoise * rng.normal();
    }
    add_record(out.channel, std::move(A), 100.0, 0.25 * kNoise * kNoise, kNoise * kNoise);
  }
  return out;
}

MixedFit fit_of(const MixedProblem& p, const std::vector<int>& columns) {
  MixedFit fit = fit_mixed(p, columns, nullptr, 30, RecordUse::all_records);
  EXPECT_TRUE(fit.valid);
  return fit;
}

double mean_left_out(const MixedProblem& p, const MixedFit& fit) {
  const LeftOut out = leave_one_out(p, fit, &fit);
  double sum = 0.0;
  for (const double square : out.adapted) sum += square;
  return std::sqrt(sum / kRecords);
}

TEST(GainOfRecord, MultipliesWhatAnEffectAdds) {
  const Made m = make(GrowsWithGain::with_it, 0.0);
  const MixedFit fit = fit_of(m.channel.problem, {kEffect});
  EXPECT_NEAR(fit.coefficient[2], kStrength * fit.coefficient[0], 0.002);
  EXPECT_LT(mean_left_out(m.channel.problem, fit), 1.05 * kNoise);
  EXPECT_LT(strength_scatter(m.channel.problem, fit, {kEffect}), 0.005);
  for (std::size_t k = 0; k < kRecords; ++k) EXPECT_NEAR(fit.gain[k] + fit.coefficient[0], 1.0 + m.gain[k], 0.002) << k;
}

// One round has no second chance to find what a unit of gain adds to the strengths.
TEST(GainOfRecord, IsThatOfAFitOfTheWholeProblemInOneOfSomeColumns) {
  const Made m = make(GrowsWithGain::with_it, 0.1);
  const MixedFit whole = fit_of(m.channel.problem, {kEffect, kCause});
  const std::vector<int> turned = {kCause, kEffect};
  const MixedProblem some = with_columns(m.channel.problem, turned);
  const MixedFit start = with_columns(whole, turned);
  const MixedFit one = fit_mixed(some, {0, 1}, &start, 1, RecordUse::all_records);
  ASSERT_TRUE(one.valid);
  const MixedFit of_whole = fit_mixed(m.channel.problem, turned, &whole, 1, RecordUse::all_records);
  EXPECT_NEAR(one.per_gain[2], of_whole.per_gain[2], 1e-9);
  EXPECT_NEAR(one.per_gain[3], of_whole.per_gain[3], 1e-9);
  EXPECT_GT(std::abs(one.per_gain[2] - one.per_gain[3]), 0.01);
}

TEST(GainOfRecord, DoesNotMultiplyWhatStandsByItself) {
  const Made grows = make(GrowsWithGain::never, 0.0), stands = make(GrowsWithGain::never, 0.0, false);
  EXPECT_GT(mean_left_out(grows.channel.problem, fit_of(grows.channel.problem, {kEffect})), 5.0 * kNoise);
  EXPECT_LT(mean_left_out(stands.channel.problem, fit_of(stands.channel.problem, {kEffect})), 1.05 * kNoise);
}

TEST(GainOfRecord, OfACauseMultipliesItToo) {
  const Made m = make(GrowsWithGain::with_it, 0.1);
  const MixedFit fit = fit_of(m.channel.problem, {kEffect, kCause}), without = fit_of(m.channel.problem, {kEffect});
  EXPECT_NEAR(fit.coefficient[3], 0.1, 0.06);
  EXPECT_LT(fit.variance[0], 0.5 * without.variance[0]);
  EXPECT_LT(mean_left_out(m.channel.problem, fit), 1.05 * kNoise);
  for (std::size_t k = 0; k < kRecords; ++k)
    EXPECT_NEAR(fit.gain[k] + fit.coefficient[0], 1.0 + m.gain[k] + 0.1 * m.cause[k], 0.002) << k;
}

TEST(GainOfRecord, IsTakenOffTheResidualWithAllThatItMultiplies) {
  const Made m = make(GrowsWithGain::with_it, 0.1);
  const MixedFit fit = fit_of(m.channel.problem, {kEffect, kCause});
  const std::vector<std::vector<double>> rows = residual_rows(m.channel, fit);
  for (std::size_t k = 0; k < kRecords; ++k) {
    double sum = 0.0;
    for (const double e : rows[k]) sum += e * e;
    EXPECT_NEAR(std::sqrt(sum / static_cast<double>(rows[k].size())), std::sqrt(fit.adapted[k]), 1e-3 * kNoise) << k;
  }
}

TEST(GainOfRecord, IsToldBesideTheEffectsThatGrowWithIt) {
  const Made m = make(GrowsWithGain::with_it, 0.0);
  CampaignInput campaign;
  campaign.records.resize(kRecords);
  const RecordLevels levels = record_levels(campaign, m.channel, fit_of(m.channel.problem, {kEffect}));
  double mean = 0.0;
  for (const double g : m.gain) mean += g / kRecords;
  for (int k = 0; k < kRecords; ++k) {
    EXPECT_NEAR(levels.gain.value[k] - levels.gain.value.mean(), m.gain[static_cast<std::size_t>(k)] - mean, 0.001) << k;
    EXPECT_NEAR(levels.gain_of_column(k, kCause), m.cause[static_cast<std::size_t>(k)], 0.001) << k;
    EXPECT_NEAR(levels.zero_of_column(k, kCause), 0.0, 0.001) << k;
  }
}

}  // namespace
}  // namespace forcegate::diagnose
