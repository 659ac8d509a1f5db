#include "hil/diagnose/base/own_decay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/diagnose/base/base_fit.h"
#include "hil/model/rows.h"

namespace forcegate::diagnose {
namespace {

/// Fast edges between 0.5 and 3.5 N, and an output that is late by 12 ms and loses `depth` of its swing.
RecordInput edges(double depth) {
  RecordInput r;
  const auto force = [](double t) { return 2.0 + 1.5 * std::tanh(8.0 * std::sin(1.7 * t)); };
  r.duration_s = 60.0;
  r.F_min_N = 0.5;
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.02 * i, late = t - 0.012;
    r.t_s.push_back(t);
    r.F_N.push_back(force(t));
    const double D = 1.0 - depth * -std::expm1(-0.05 * t);
    r.U_V.push_back(2.0 * (0.5 + D * (force(late) - 0.5)) + 0.01 * std::sin(37.0 * t));
    r.ok.push_back(1);
  }
  r.rate_N_per_s.assign(r.rows(), 0.0);
  for (std::size_t i = 1; i + 1 < r.rows(); ++i) r.rate_N_per_s[i] = (r.F_N[i + 1] - r.F_N[i - 1]) / 0.04;
  return r;
}

TEST(OwnDecay, ADecayIsSeenBesideALagThatMakesMostOfTheError) {
  EXPECT_TRUE(decays_by_itself(edges(0.06)));
  EXPECT_FALSE(decays_by_itself(edges(0.0)));
}

// Beside the curve of an FSR a straight line leaves more than the decay does.
TEST(OwnDecay, ADecayIsSeenBesideABentCurve) {
  const auto bent = [](double depth) {
    RecordInput r = edges(0.0);
    for (std::size_t i = 0; i < r.rows(); ++i) {
      r.F_N[i] = 2.0 - 1.5 * std::cos(1.7 * r.t_s[i]);
      const double D = 1.0 + depth * std::expm1(-0.05 * r.t_s[i]), y = 0.5 + D * (r.F_N[i] - 0.5);
      r.U_V[i] = 4.0 * y / (y + 2.0) + 0.01 * std::sin(37.0 * r.t_s[i]);
    }
    return r;
  };
  EXPECT_TRUE(decays_by_itself(bent(0.12)));
  EXPECT_FALSE(decays_by_itself(bent(0.0)));
}

// F'' of a sine is the force itself: either column, and any part of both, has its slope.
TEST(OwnDecay, TheDepthOfASineIsThatOfItsWholeSlope) {
  for (const double depth : {0.1, 0.5}) {
    RecordInput r = edges(0.0);
    for (std::size_t i = 0; i < r.rows(); ++i) {
      r.F_N[i] = 2.0 - 1.5 * std::cos(1.7 * r.t_s[i]);
      r.rate_N_per_s[i] = 1.5 * 1.7 * std::sin(1.7 * r.t_s[i]);
      r.U_V[i] = 2.0 * (0.5 + (1.0 + depth * std::expm1(-0.05 * r.t_s[i])) * (r.F_N[i] - 0.5));
    }
    EXPECT_NEAR(own_decay(r, choose_rows(r, 4000), Rates::between).depth, depth, 0.02 * depth);
  }
}

TEST(OwnDecay, ALostRowHidesNone) {
  RecordInput r = edges(0.06);
  for (std::size_t i = 500; i < 2500; i += 400) {
    r.F_N[i] = r.U_V[i] = r.rate_N_per_s[i - 1] = r.rate_N_per_s[i + 1] = kMissing;
    r.ok[i] = 0;
  }
  EXPECT_TRUE(decays_by_itself(r));
  EXPECT_TRUE(std::isfinite(left_by_decay(r)));
}

// The room cools and the gain with it: the same course as a decay, and its cause is recorded.
TEST(OwnDecay, ARecordedTemperatureTakesWhatItDoesToTheGain) {
  const auto cooling = [](double per_degC, double depth) {
    RecordInput r = edges(depth);
    for (std::size_t i = 0; i < r.rows(); ++i) {
      r.temp_C.push_back(20.0 + 4.0 * std::exp(-0.06 * r.t_s[i]) + 0.05 * std::sin(2.1 * r.t_s[i]));
      r.U_V[i] += 2.0 * r.F_N[i] * per_degC * (r.temp_C[i] - 24.0);
    }
    return r;
  };
  EXPECT_FALSE(decays_by_itself(cooling(0.02, 0.0)));
  EXPECT_TRUE(decays_by_itself(cooling(0.0, 0.3)));
}

/// A sum of three sines of which the lowest force is touched for less than a hundredth of the time, decaying about `F_min_N`.
RecordInput beats_about(double F_min_N) {
  RecordInput r = edges(0.0);
  for (std::size_t i = 0; i < r.rows(); ++i) {
    const double t = r.t_s[i];
    r.F_N[i] = 3.0 + std::sin(0.8 * t) + std::sin(1.9 * t + 1.0) + 0.8 * std::sin(3.3 * t + 2.0);
    r.U_V[i] = 2.0 * (F_min_N + (1.0 + 0.5 * std::expm1(-0.05 * t)) * (r.F_N[i] - F_min_N)) + 0.01 * std::sin(37.0 * t);
  }
  estimate_excitation(r, nullptr, 5.0);
  return r;
}

TEST(OwnDecay, ARareLowestForceIsFoundByTheDecayThatTurnsAboutIt) {
  const RecordInput r = beats_about(0.0);
  const double lowest = std::ranges::min(r.F_N), usual = r.F_min_N;
  ASSERT_GT(usual, lowest + 0.1);
  EXPECT_NEAR(lowest_force_of_decay(beats_about(lowest)), lowest, 0.05);
  EXPECT_EQ(lowest_force_of_decay(beats_about(usual)), usual);
  EXPECT_EQ(lowest_force_of_decay(edges(0.3)), 0.5);
}

// Two cycles of ten seconds, of which three turns show.
TEST(OwnDecay, TwoCyclesThatAreCalledCyclesAreAskedWhetherTheyDecay) {
  const auto two_cycles = [](const std::string& kind) {
    RecordInput r = edges(0.0);
    std::size_t n = 0;
    for (; n < r.rows() && r.t_s[n] < 20.5; ++n) r.F_N[n] = 5.0 - 4.0 * std::cos(0.2 * std::numbers::pi * r.t_s[n]);
    for (auto* channel : {&r.t_s, &r.F_N, &r.U_V, &r.rate_N_per_s}) channel->resize(n);
    r.ok.resize(n);
    r.duration_s = r.t_s.back();
    r.kind = kind;
    estimate_excitation(r, nullptr, 10.0, 4);
    return r.dynamic;
  };
  EXPECT_TRUE(two_cycles("sine"));
  EXPECT_FALSE(two_cycles("")) << "up and down, and up and down again: it may be two ramps";
  EXPECT_FALSE(two_cycles("ramp"));
}

// A tenth of a degree goes with the decay by chance.
TEST(OwnDecay, ATemperatureThatHardlyChangesTakesNoDecay) {
  RecordInput r = edges(0.3);
  for (std::size_t i = 0; i < r.rows(); ++i) r.temp_C.push_back(21.0 + 0.1 * std::expm1(-0.05 * r.t_s[i]));
  EXPECT_TRUE(decays_by_itself(r));
}

TEST(OwnDecay, ItsRateIsFoundBetweenThoseOfTheGrid) {
  for (const double rate_per_s : {0.041, 0.05, 0.061}) {
    RecordInput r = edges(0.0);
    for (std::size_t i = 0; i < r.rows(); ++i) r.U_V[i] = 2.0 * (0.5 + (1.0 + 0.5 * std::expm1(-rate_per_s * r.t_s[i])) * (r.F_N[i] - 0.5));
    const std::vector<std::size_t> rows = choose_rows(r, 4000);
    EXPECT_NEAR(own_decay(r, rows, Rates::between).rate_per_s, rate_per_s, 0.01 * rate_per_s);
    EXPECT_LT(left_by_decay(r), 1e-5);
  }
}

// A swing that grows is no decay of any rate: what is left is that of a straight line.
TEST(OwnDecay, OfASwingThatGrowsAStraightLineIsLeft) {
  RecordInput r = edges(0.0);
  for (std::size_t i = 0; i < r.rows(); ++i) r.U_V[i] = 2.0 * (0.5 + (1.0 - 0.3 * std::expm1(-0.05 * r.t_s[i])) * (r.F_N[i] - 0.5));
  EXPECT_FALSE(decays_by_itself(r));
  EXPECT_LT(left_by_decay(r), 1.0);
}

}  // namespace
}  // namespace forcegate::diagnose
