// What shows right where it acts: an output that stands still above a force, and jumps at the codes of a converter.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "hil/base/rng.h"
#include "hil/diagnose/choose/code_jumps.h"
#include "hil/diagnose/choose/flat_top.h"

namespace forcegate::diagnose {
namespace {

// Three records of a force that swings over 4 N, each with a gain and a zero of its own.
CampaignInput swings(const std::function<double(double)>& output, double noise_V = 0.003) {
  CampaignInput c;
  c.range_N = 4.0;
  for (int k = 0; k < 3; ++k) {
    Rng rng(k + 1, "swings");
    RecordInput r;
    for (int i = 0; i < 4000; ++i) {
      const double t_s = 0.02 * i, F_N = 2.0 - 2.0 * std::cos(2.0 * std::numbers::pi * (0.21 + 0.03 * k) * t_s);
      r.t_s.push_back(t_s);
      r.F_N.push_back(F_N);
      r.U_V.push_back((1.0 + 0.01 * k) * output(F_N) + 0.02 * k + noise_V * rng.normal());
    }
    r.ok.assign(r.rows(), 1);
    r.decay.assign(r.rows(), 1.0);
    c.records.push_back(std::move(r));
  }
  return c;
}

double bent(double F_N) { return 0.2 + 2.5 * std::pow(F_N, 0.75); }

TEST(FlatTop, AnOutputThatStopsStandsStillAboveItsCorner) {
  const double corner_N = 3.4;
  EXPECT_TRUE(stands_still_above(swings([&](double F) { return bent(std::min(F, corner_N)); }), corner_N));
  EXPECT_FALSE(stands_still_above(swings([&](double F) { return bent(std::min(F, corner_N)); }), 2.4)) << "it goes on rising there";
}

TEST(FlatTop, ASmoothCurveDoesNot) {
  EXPECT_FALSE(stands_still_above(swings(bent), 3.4));
  EXPECT_FALSE(stands_still_above(swings([](double F) { return 5.0 * (1.0 - std::exp(-F / 1.5)); }), 3.4)) << "it saturates";
}

TEST(FlatTop, NothingIsSaidWhereTheForceHardlyGoes) {
  EXPECT_FALSE(stands_still_above(swings([](double F) { return bent(std::min(F, 3.4)); }), 3.99));
  CampaignInput no_output = swings(bent);
  for (RecordInput& r : no_output.records) r.U_V.clear();
  EXPECT_FALSE(stands_still_above(no_output, 3.4));
}

// The highest bits of 10 V weigh too much or too little.
double converted(double U_V, double half_V, double quarter_V) { return U_V + (U_V >= 5.0 ? half_V : 0.0) + (std::fmod(U_V, 5.0) >= 2.5 ? quarter_V : 0.0); }

TEST(CodeJumps, WrongBitsJumpAtTheirCodesBehindAnyCurve) {
  EXPECT_TRUE(jumps_at_codes(swings([](double F) { return converted(bent(F), 0.06, -0.04); }), 0.0, 10.0));
  EXPECT_TRUE(jumps_at_codes(swings([](double F) { return converted(bent(F), -0.06, 0.04); }), 0.0, 10.0));
}

TEST(CodeJumps, ACurveALoopAndAnotherRangeHaveNone) {
  EXPECT_FALSE(jumps_at_codes(swings(bent), 0.0, 10.0));
  double last_N = 0.0;
  const auto late = [&](double F) { return last_N += 0.2 * (F - last_N), bent(std::max(0.0, last_N)); };
  EXPECT_FALSE(jumps_at_codes(swings(late), 0.0, 10.0));
  EXPECT_FALSE(jumps_at_codes(swings([](double F) { return converted(bent(F), 0.06, -0.04); }), 0.0, 8.0)) << "its codes lie elsewhere";
}

TEST(CodeJumps, OneJumpIsNoConverter) {
  EXPECT_FALSE(jumps_at_codes(swings([](double F) { return bent(F) + (bent(F) >= 5.0 ? 0.1 : 0.0); }), 0.0, 10.0)) << "a fixture that snaps";
}

TEST(CodeJumps, TooFewPassagesSayNothing) {
  CampaignInput c = swings([](double F) { return converted(bent(F), 0.06, -0.04); });
  c.records.resize(1);
  RecordInput& r = c.records.front();
  for (auto* x : {&r.t_s, &r.F_N, &r.U_V, &r.decay}) x->resize(200);
  r.ok.resize(200);
  EXPECT_FALSE(jumps_at_codes(c, 0.0, 10.0));
}

}  // namespace
}  // namespace forcegate::diagnose
