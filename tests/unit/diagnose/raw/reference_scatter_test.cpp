#include "hil/diagnose/raw/reference_scatter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "hil/base/rng.h"

namespace forcegate::diagnose {
namespace {

struct Made {
  std::vector<double> t, F, U;
};

// 2 V/N; `keep`: coloured noise of the reference, `shake`: the force itself trembles and the output sees it.
Made make(double noise_N, double keep, double shake_N) {
  Made out;
  Rng rng(51, "scatter");
  double e = 0.0, s = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double t = i / 500.0, force = 2.0 + std::sin(2.0 * t);
    e = keep * e + std::sqrt(1.0 - keep * keep) * rng.normal();
    s = 0.7 * s + std::sqrt(1.0 - 0.49) * rng.normal();
    out.t.push_back(t);
    out.F.push_back(force + noise_N * e + shake_N * s);
    out.U.push_back(2.0 * (force + shake_N * s) + 0.002 * rng.normal());
  }
  return out;
}

double scatter(const Made& m) { return reference_scatter(m.t, m.F, m.U, {.range_V = 4.0, .gain_V_per_N = 2.0}).quartile_N; }

TEST(ReferenceScatter, SeesWhiteAndColouredNoiseAlike) {
  EXPECT_NEAR(scatter(make(0.03, 0.0, 0.0)), 0.03, 0.004);
  EXPECT_NEAR(scatter(make(0.03, 0.8, 0.0)), 0.03, 0.008);
}

TEST(ReferenceScatter, SeesItInARecordOfASecond) {
  Made m = make(0.03, 0.0, 0.0);
  for (std::vector<double>* v : {&m.t, &m.F, &m.U}) v->resize(500);
  const ReferenceScatter found = reference_scatter(m.t, m.F, m.U, {.range_V = 4.0, .gain_V_per_N = 2.0, .noise_V = 0.002});
  EXPECT_NEAR(found.alone_N, 0.03, 0.012);
  EXPECT_GT(found.quartile_N, 0.02);
}

TEST(ReferenceScatter, LeavesOutAForceThatReallyTrembles) {
  EXPECT_LT(scatter(make(0.005, 0.0, 0.05)), 0.008);
}

TEST(ReferenceScatter, SaysNothingOfAFastSineWhereALateReferenceWouldScatter) {
  Made m;
  Rng rng(53, "late");
  for (int i = 0; i < 6000; ++i) {
    const double t = i / 50.0;
    const auto force = [](double at) { return 2.0 + 1.4 * std::sin(25.0 * at); };
    m.t.push_back(t);
    m.F.push_back(force(t - 0.001) + 0.005 * rng.normal());
    m.U.push_back(2.0 * force(t) + 0.002 * rng.normal());
  }
  EXPECT_EQ(scatter(m), 0.0);
}

// A pad that answers within 70 ms, hit every 2 s, just before a window of half a second ends.
TEST(ReferenceScatter, ALoadThatTheOutputHasNotSeenYetIsNoNoise) {
  Made m;
  Rng rng(54, "pad");
  double answer = 1.0;
  for (int i = 0; i < 12000; ++i) {
    const double t = i / 500.0, since = std::fmod(t, 2.0) - 0.485;
    const double level = 1.0 + 0.7 * (static_cast<int>(t / 2.0) % 2), force = std::lerp(level, 2.7 - level, std::clamp(since / 0.03, 0.0, 1.0));
    answer += (force - answer) * -std::expm1(-1.0 / (500.0 * 0.07));
    m.t.push_back(t);
    m.F.push_back(force + 0.005 * rng.normal());
    m.U.push_back(2.0 * answer + 0.002 * rng.normal());
  }
  EXPECT_NEAR(reference_scatter(m.t, m.F, m.U, {.range_V = 4.0, .gain_V_per_N = 2.0}).still_N, 0.005, 0.001);
}

TEST(ReferenceScatter, GivesNothingForAFewSamples) {
  Made m = make(0.03, 0.0, 0.0);
  m.t.resize(100);
  EXPECT_EQ(scatter(m), 0.0);
}

// 40 s of holds of 2 s with fast moves between; the noise comes in bursts of 50 ms that fill three tenths of the time.
Made make_bursts(double quiet_N, double burst_N) {
  Made out;
  Rng rng(52, "bursts");
  double level = 1.0;
  for (int i = 0; i < 20000; ++i) {
    const double t = i / 500.0;
    if (i % 1000 == 0) level = rng.uniform(0.5, 4.0);
    const double moving = i % 1000 < 400 ? std::sin(30.0 * t) : 0.0;
    const double noise = i % 83 < 25 ? burst_N : quiet_N;
    out.t.push_back(t);
    out.F.push_back(level + moving + noise * rng.normal());
    out.U.push_back(2.0 * level + 1.5 * moving + 0.001 * rng.normal());
  }
  return out;
}

TEST(ReferenceScatter, WhereTheOutputStandsStillBurstsCount) {
  const Made m = make_bursts(0.005, 0.05);
  const double power = std::sqrt(0.7 * 0.005 * 0.005 + 0.3 * 0.05 * 0.05);
  EXPECT_NEAR(reference_scatter(m.t, m.F, m.U, {.range_V = 8.0, .gain_V_per_N = 2.0}).still_N, power, 0.15 * power);
}

TEST(ReferenceScatter, AForceThatSwingsBelowTheNoiseOfTheOutputIsNoScatter) {
  Made m;
  Rng rng(54, "swing");
  for (int i = 0; i < 8000; ++i) {
    const double t = i / 20.0, swing = 0.02 * std::sin(9.0 * t) * (1.0 + 0.3 * std::sin(0.2 * t));
    m.t.push_back(t);
    m.F.push_back(3.0 + swing + 0.008 * rng.normal());
    m.U.push_back(2.0 * (3.0 + swing) + 0.04 * rng.normal());
  }
  EXPECT_NEAR(reference_scatter(m.t, m.F, m.U, {.range_V = 12.0, .gain_V_per_N = 2.0}).still_N, 0.008, 0.0015);
}

TEST(ReferenceScatter, SaysNothingOfStillnessWhereTheOutputNeverStands) {
  const Made m = make(0.03, 0.0, 0.0);
  EXPECT_EQ(reference_scatter(m.t, m.F, m.U, {.range_V = 4.0, .gain_V_per_N = 2.0}).still_N, 0.0);
}

// Staircases of five seconds a level under noise that hangs together over a tenth of a second: neighbours differ by a fifth of it.
TEST(ReferenceScatter, OfNoiseThatHangsTogetherSmoothingLeavesNearlyAll) {
  Made m;
  std::vector<double> smoothed;
  Rng rng(57, "levels");
  const double keep = std::exp(-0.005 / 0.1);
  double e = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double t = i / 200.0, force = 1.0 + 0.5 * std::floor(std::fmod(t, 40.0) / 5.0);
    e = keep * e + std::sqrt(1.0 - keep * keep) * rng.normal();
    m.t.push_back(t);
    m.F.push_back(force + 0.03 * e);
    m.U.push_back(2.0 * force + 0.002 * rng.normal());
    smoothed.push_back(force + 0.024 * e);
  }
  const OutputFacts facts{.range_V = 8.0, .gain_V_per_N = 2.0, .noise_V = 0.002};
  EXPECT_NEAR(left_where_still(m.t, m.F, smoothed, m.U, facts), 0.020, 0.003) << "a parabola over two seconds takes some of it";
  for (std::size_t i = 0; i < m.U.size(); ++i) m.U[i] += 0.5 * std::sin(20.0 * m.t[i]);
  EXPECT_EQ(left_where_still(m.t, m.F, smoothed, m.U, facts), 0.0) << "the output never stands still";
}

// An output that waits for a long dead time stands still while the load has its new level already.
TEST(ReferenceScatter, TakesNoLoadForNoiseWhereTheOutputIsLate) {
  Made m;
  Rng rng(57, "steps");
  double level = 2.0;
  for (int i = 0; i < 4000; ++i) {
    if (i % 60 == 0) level = 0.5 + 3.0 * rng.uniform();
    m.t.push_back(i);
    m.F.push_back(level + 0.01 * rng.normal());
  }
  for (std::size_t i = 0; i < m.F.size(); ++i) m.U.push_back(2.0 * m.F[i >= 12 ? i - 12 : 0]);
  const OutputFacts output{.range_V = 6.0, .gain_V_per_N = 2.0};
  EXPECT_LT(reference_scatter(m.t, m.F, m.U, output).still_N, 0.1);
  EXPECT_LT(left_where_still(m.t, m.F, m.F, m.U, output), 0.1);
}

ReferenceScatter in_bursts(double burst_N, double share, double ring_N) {
  Made m;
  Rng rng(57, "bursts");
  for (int i = 0; i < 20000; ++i) {
    const double t = i / 500.0, force = 2.0 + 0.5 * std::floor(t / 10.0), in_second = t - std::floor(t);
    m.t.push_back(t);
    const double knock = in_second < 0.2 ? ring_N * std::exp(-20.0 * in_second) * std::sin(150.0 * in_second) : 0.0;
    m.F.push_back(force + (in_second < share ? burst_N : 0.004) * rng.normal() + knock);
    m.U.push_back(2.0 * force + 0.004 * rng.normal());
  }
  m.U[0] = 0.0;
  return reference_scatter(m.t, m.F, m.U, {.range_V = 6.0, .gain_V_per_N = 2.0, .noise_V = 0.004});
}

TEST(ReferenceScatter, TellsNoiseThatComesInBurstsFromWhatIsUsual) {
  const ReferenceScatter found = in_bursts(0.1, 0.3, 0.0);
  EXPECT_NEAR(found.burst_N, 0.1, 0.03);
  EXPECT_NEAR(found.between_bursts_N, 0.004, 0.001);
  EXPECT_NEAR(found.burst_share, 0.35, 0.16);
  EXPECT_EQ(in_bursts(0.004, 0.3, 0.0).burst_N, 0.0);
  EXPECT_EQ(in_bursts(0.012, 0.3, 0.0).burst_N, 0.0) << "three times as restless is no burst";
}

TEST(ReferenceScatter, AKnockThatRingsIsNoBurstOfNoise) { EXPECT_EQ(in_bursts(0.004, 0.3, 0.2).burst_N, 0.0); }

}  // namespace
}  // namespace forcegate::diagnose
