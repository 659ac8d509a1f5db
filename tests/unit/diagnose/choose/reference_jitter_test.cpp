#include "hil/diagnose/choose/reference_jitter.h"

#include "tests/unit/diagnose/made_campaign.h"
#include "tests/unit/diagnose/made_channel.h"

namespace forcegate::diagnose {
namespace {

// Six records of ten levels each, U = F. The reference reads each with a noise that the output never sees (column 0 holds it); `loop` differs
// between the levels that were loaded and unloaded, `noise` is the noise itself.
enum Column { kLoop, kNoise };

ResidualChannel levels(double loop, double memory = 0.0) {
  ResidualChannel channel = channel_of_lines(2, 2.0);
  Rng rng(61, "jitter");
  double noise = 0.0;
  for (int k = 0; k < 6; ++k) {
    Eigen::MatrixXd rows(500, 5);
    for (int i = 0; i < 500; ++i) {
      const int level = i / 50, step = level < 5 ? level : 9 - level;
      const double F = 0.2 * step, side = level < 5 ? -0.001 : 0.001;
      noise = memory * noise + 0.001 * std::sqrt(1.0 - memory * memory) * rng.normal();
      rows.row(i) << F + noise, 1.0, side, noise, F + loop * side + 1e-4 * rng.normal();
    }
    add_record(channel, std::move(rows), 100.0, 1e-8, 1e-8);
  }
  return channel;
}

double share_of(const ResidualChannel& channel, Column column) {
  const MixedFit before = fit_mixed(channel.problem, {}, nullptr, 20, RecordUse::all_records);
  const MixedFit after = fit_mixed(channel.problem, {column}, &before, 20, RecordUse::all_records);
  EXPECT_TRUE(before.valid && after.valid);
  return share_of_jitter(channel, before, after);
}

TEST(ReferenceJitter, WhatFlattensTheNoiseOfTheReferenceTakesNothingElse) { EXPECT_GT(share_of(levels(0.0), kNoise), 0.8); }

TEST(ReferenceJitter, NoiseThatAWideWindowSmoothedIsJitterToo) { EXPECT_GT(share_of(levels(0.0, 0.8), kNoise), 0.7); }

TEST(ReferenceJitter, ALoopBetweenStandingLevelsTakesNoneOfIt) { EXPECT_NEAR(share_of(levels(1.0), kLoop), 0.0, 0.1); }

TEST(ReferenceJitter, NorUnderARestlessOne) { EXPECT_NEAR(share_of(levels(1.0, 0.95), kLoop), 0.0, 0.1); }

// Smoothing leaves more than a hundredth of the span: levels stand still within their noise all the same.
TEST(ReferenceJitter, NoiseBeyondAHundredthOfTheSpanStandsStillToo) {
  ResidualChannel channel = levels(0.0, 0.8);
  constexpr double kLarger = 12.0;
  for (std::size_t k = 0; k < channel.rows.size(); ++k) {
    Eigen::MatrixXd& A = channel.rows[k].matrix;
    A.col(0) += (kLarger - 1.0) * A.col(3);
    channel.problem.records[k].gram = A.transpose() * A / static_cast<double>(A.rows());
    channel.problem.records[k].smoothed_variance = std::pow(kLarger * 0.001, 2);
  }
  EXPECT_GT(share_of(channel, kNoise), 0.7);
}

// A reference whose noise hangs together over 30 ms: local parabolas leave part of it, and a play of its width would flatten it.
TEST(ReferenceJitter, ARestlessReferenceOverStandingWeightsIsNoLoop) {
  for (const std::uint64_t seed : {81u, 82u, 83u}) {
    Campaign c = make_campaign(seed, straight, 0.001);
    Rng rng(seed, "restless");
    for (std::size_t k = 0; k < c.records.size(); ++k) {
      auto& F = c.records[k].trace.find("F_ref")->value;
      auto& U = c.records[k].trace.find("U")->value;
      c.records[k].kind = "staircase";
      double slow = 0.0;
      for (std::size_t i = 0; i < F.size(); ++i) {
        const double t = static_cast<double>(i) / 200.0, at = std::floor(t / 12.0), level = 0.5 + 0.7 * std::min(at, 9.0 - at) + 0.05 * static_cast<double>(k);
        slow = 0.85 * slow + std::sqrt(1.0 - 0.85 * 0.85) * rng.normal();
        F[i] = std::round((level + 0.010 * rng.normal() + 0.007 * slow) / 0.01) * 0.01;
        U[i] = 2.0 * level + 0.2 + 0.002 * rng.normal();
      }
    }
    c.bench.reference_resolution_N = 0.01;
    c.bench.reference_noise_N = 0.0125;
    const Diagnosis d = answer(std::move(c));
    EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << seed << "\n" << told(d);
  }
}

}  // namespace
}  // namespace forcegate::diagnose
