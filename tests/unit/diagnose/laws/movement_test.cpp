#include "hil/diagnose/laws/movement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "hil/base/rng.h"

namespace forcegate::diagnose {
namespace {

std::vector<double> series(std::size_t n, double noise, std::uint64_t seed, const std::function<double(double)>& course) {
  Rng rng(seed, "movement");
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(course(static_cast<double>(i) / static_cast<double>(n)) + noise * rng.normal());
  return out;
}

TEST(Movement, WhiteNoiseDoesNotStandOutOfItself) {
  for (const std::size_t n : {64u, 1000u, 200000u})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const Movement m = movement_of(series(n, 0.004, seed, [](double) { return 2.0; }));
      EXPECT_FALSE(m.stands_out()) << n << " " << seed;
      EXPECT_NEAR(m.noise, 0.004, 0.0015);
      EXPECT_NEAR(m.level, 2.0, 0.003);
    }
}

TEST(Movement, AStepOfAFewSamplesAndARampBelowTheNoiseOfASampleStandOut) {
  const auto blip = [](double x) { return x > 0.5 && x < 0.5003 ? 0.04 : 0.0; };  // nine samples
  EXPECT_NEAR(movement_of(series(30000, 0.004, 3, blip)).excursion, 0.04, 0.01);
  EXPECT_NEAR(movement_of(series(30000, 0.004, 3, [](double x) { return 0.003 * x; })).excursion, 0.003, 0.001);
}

TEST(Movement, WhatFlickersBetweenTwoCodesIsNoise) {
  std::vector<double> rare = series(20000, 0.004, 5, [](double) { return 0.0; });
  for (double& v : rare) v = v > 0.011 ? 0.025 : 0.0;  // three in a thousand
  EXPECT_FALSE(movement_of(rare).stands_out());
  EXPECT_TRUE(movement_of(series(4000, 0.0, 1, [](double x) { return std::sin(60.0 * x) > 0.0 ? 0.025 : 0.0; })).stands_out());
  EXPECT_TRUE(movement_of(series(100, 0.0, 1, [](double x) { return x == 0.5 ? 2.5 : 2.0; })).stands_out());
}

TEST(Movement, OutputThatFollowsSampleBySampleIsSeenBelowTheNoise) {
  const std::vector<double> force = series(20000, 0.004, 7, [](double) { return 2.0; });
  std::vector<double> follows = series(20000, 0.016, 8, [](double) { return 4.0; });
  EXPECT_FALSE(response_by_scale(force, follows).found);
  for (std::size_t i = 0; i < force.size(); ++i) follows[i] += 2.0 * (force[i] - 2.0);
  const Response r = response_by_scale(force, follows);
  ASSERT_TRUE(r.found);
  EXPECT_LT(r.at_least, 2.2);
  EXPECT_GT(r.at_most, 1.8);
}

TEST(Movement, TwoWandersAreNoResponse) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    std::vector<double> a = series(4000, 1.0, seed, [](double) { return 0.0; }), b = series(4000, 1.0, seed + 1000, [](double) { return 0.0; });
    for (std::size_t i = 1; i < a.size(); ++i) a[i] += a[i - 1], b[i] += b[i - 1];
    found += response_by_scale(a, b).found;
  }
  EXPECT_LE(found, 1);
  const auto slow = [](double x) { return std::sin(13.0 * x); };
  const auto other = [](double x) { return std::sin(13.0 * x + 1.0); };
  EXPECT_FALSE(response_by_scale(series(30000, 0.01, 1, slow), series(30000, 0.01, 2, other)).found);
}

TEST(Movement, ACourseThatFollowsAsAWholeHasItsSlope) {
  const auto ramp = [](double x) { return 0.02 * x; };
  const Response r = response_as_a_whole(series(30000, 0.004, 1, ramp), series(30000, 0.008, 2, [&](double x) { return 2.0 * ramp(x); }));
  ASSERT_TRUE(r.found);
  EXPECT_NEAR(r.at_least, 2.0, 0.2);
  EXPECT_FALSE(response_as_a_whole(series(30000, 0.004, 1, ramp), series(30000, 0.008, 2, [](double) { return 0.0; })).found);
}

TEST(Movement, SamplesOfAnotherClockAreReadAlongStraightLines) {
  const std::vector<double> out = at_times({0.0, 1.0, 2.0, 3.0}, {0.0, std::nan(""), 4.0, 6.0}, {-1.0, 0.5, 1.0, 3.0, 4.0});
  EXPECT_TRUE(std::isnan(out[0]) && std::isnan(out[4]));
  EXPECT_DOUBLE_EQ(out[1], 1.0);
  EXPECT_DOUBLE_EQ(out[2], 2.0);
  EXPECT_DOUBLE_EQ(out[3], 6.0);
}

}  // namespace
}  // namespace forcegate::diagnose
