#include "golden/compare/tube.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hil/base/rng.h"

namespace forcegate {
namespace {

std::vector<float> sine(std::size_t n, double f_Hz, double shift_s = 0.0, double step_s = 0.001) {
  std::vector<float> v(n);
  for (std::size_t i = 0; i < n; ++i)
    v[i] = static_cast<float>(2.0 +
                              1.5 * std::sin(2 * M_PI * f_Hz * (static_cast<double>(i) * step_s - shift_s)));
  return v;
}

TubeResult compare(const std::vector<float>& g, const std::vector<float>& x, TubeOptions o,
                   double step_s = 0.001) {
  const auto r = compare_tube({0.0, step_s, g}, {0.0, step_s, x}, o);
  EXPECT_TRUE(r) << r.error().to_text();
  return r.value_or(TubeResult{});
}

TubeOptions absolute(double a) {
  TubeOptions o;
  o.absolute = a;
  o.lag_limit_s = std::numeric_limits<double>::infinity();
  return o;
}

// The definition, on a grid of 1/40 step; exact where time_s is a multiple of that.
double brute_margin(const std::vector<float>& g, double x, std::size_t i, const TubeOptions& o,
                    double step_s) {
  float low = g[0], high = g[0];
  for (const float v : g) low = std::min(low, v), high = std::max(high, v);
  const double floor = std::max(o.absolute, o.scale * (static_cast<double>(high) - low));
  double upper = -1e300, lower = 1e300;
  const int reach = static_cast<int>(std::lround(40.0 * o.time_s / step_s));
  for (int k = -reach; k <= reach; ++k) {
    const double at = static_cast<double>(i) + k / 40.0;
    if (at < 0 || at > static_cast<double>(g.size() - 1)) continue;
    const auto j = std::min(static_cast<std::size_t>(at), g.size() - 2);
    const double w = at - static_cast<double>(j);
    const auto edge = [&](std::size_t m, double sign) {
      return g[m] + sign * std::max(floor, o.relative * std::fabs(g[m]));
    };
    upper = std::max(upper, (1 - w) * edge(j, 1) + w * edge(j + 1, 1));
    lower = std::min(lower, (1 - w) * edge(j, -1) + w * edge(j + 1, -1));
  }
  return std::min(upper - x, x - lower);
}

TEST(Tube, MarginsFollowTheDefinitionForRandomTracesAndTolerances) {
  Rng rng(3, "tube");
  for (int round = 0; round < 40; ++round) {
    const std::size_t n = 40 + rng.below(60);
    std::vector<float> g(n), x(n);
    for (std::size_t i = 0; i < n; ++i) {
      g[i] = static_cast<float>(rng.normal());
      x[i] = g[i] + static_cast<float>(0.3 * rng.normal());
    }
    TubeOptions o = absolute(0.1 * rng.uniform());
    o.relative = 0.2 * rng.uniform();
    o.scale = 0.05 * rng.uniform();
    o.time_s = 0.001 * std::floor(40 * rng.uniform(0, 8)) / 40;
    o.keep_margins = true;
    const TubeResult r = compare(g, x, o);
    ASSERT_EQ(r.margin.size(), n);
    std::size_t outside = 0;
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(r.margin[i], brute_margin(g, x[i], i, o, 0.001), 1e-5)
          << "round " << round << " sample " << i;
      outside += r.margin[i] < 0;
    }
    EXPECT_EQ(r.n_outside, outside);
    EXPECT_EQ(r.state == TubeState::inside, outside == 0);
  }
}

TEST(Tube, ChunkBordersDoNotShow) {
  const auto g = sine(20000, 0.7);
  auto x = g;
  for (std::size_t i = 4000; i < 4200; ++i) x[i] += 0.2F;
  TubeOptions o = absolute(0.01);
  o.time_s = 0.0035;
  o.keep_margins = true;
  const TubeResult whole = compare(g, x, o);
  for (std::size_t i : {4094U, 4095U, 4096U, 4097U, 8191U, 8192U})
    EXPECT_NEAR(whole.margin[i], brute_margin(g, x[i], i, o, 0.001), 1e-5);
  EXPECT_EQ(whole.spans.size(), 1U);
  EXPECT_NEAR(whole.spans[0].from_s, 4.0, 0.02);
  EXPECT_NEAR(whole.spans[0].to_s, 4.199, 0.02);
}

TEST(Tube, ZeroMeansZero) {
  const auto g = sine(1000, 1.0);
  EXPECT_EQ(compare(g, g, absolute(0)).state, TubeState::inside);
  auto x = g;
  x[500] = std::nextafter(x[500], 10.0F);
  EXPECT_EQ(compare(g, x, absolute(0)).state, TubeState::outside);
  EXPECT_EQ(compare(g, x, absolute(0)).n_outside, 1U);
}

TEST(Tube, SamplesThatAreNotNumbersAreNeverInside) {
  const auto g = sine(101, 5.0);
  auto x = g;
  for (std::size_t i = 10; i < 80; ++i) x[i] = std::numeric_limits<float>::quiet_NaN();
  const TubeResult r = compare(g, x, absolute(100));
  EXPECT_EQ(r.state, TubeState::not_compared);
  EXPECT_EQ(r.cause, "70 of 101 tested samples are not numbers");
  EXPECT_FALSE(compare_tube({0, 0.001, x}, {0, 0.001, g}, absolute(1)))
      << "a golden with holes is a configuration error";
}

TEST(Tube, ATruncatedOrOverlongOrShiftedClockIsNotCompared) {
  const auto g = sine(1000, 5.0);
  auto x = g;
  x.resize(999);
  EXPECT_EQ(compare(g, x, absolute(100)).state, TubeState::not_compared);
  x.resize(1001);
  EXPECT_EQ(compare(g, x, absolute(100)).state, TubeState::not_compared);
  EXPECT_EQ(compare(g, {}, absolute(100)).state, TubeState::not_compared);
  EXPECT_EQ(compare_tube({0, 0.001, g}, {0, 0.002, g}, absolute(100))->state, TubeState::not_compared);
  EXPECT_EQ(compare_tube({0, 0.001, g}, {3, 0.001, g}, absolute(100))->state, TubeState::not_compared);
}

TEST(Tube, AConstantSignalKeepsItsStatedTolerance) {
  const std::vector<float> g(500, 1.5F);
  std::vector<float> x(500, 1.509F);
  EXPECT_EQ(compare(g, x, absolute(0.01)).state, TubeState::inside);
  x[3] = 1.52F;
  EXPECT_EQ(compare(g, x, absolute(0.01)).state, TubeState::outside);
  EXPECT_TRUE(std::isnan(compare(g, x, absolute(0.01)).lag_s)) << "a constant golden determines no lag";
}

TEST(Tube, ANearZeroSignalIsJudgedByItsScaleAndNotByItsValue) {
  auto g = sine(2000, 1.0);
  for (float& v : g) v = (v - 2.0F) * 1e-9F;
  auto x = g;
  x[700] += 1e-10F;
  TubeOptions o = absolute(0);
  o.scale = 0.01;
  EXPECT_EQ(compare(g, x, o).n_outside, 1U);
  o.scale = 0.1;
  EXPECT_EQ(compare(g, x, o).state, TubeState::inside);
}

TEST(Tube, ALagIsFoundAndLimitedAndRemovedOnlyOnRequest) {
  const auto g = sine(20000, 0.5);
  const auto x = sine(20000, 0.5, 0.050);
  TubeOptions o = absolute(0.02);
  o.lag_limit_s = 0.010;
  TubeResult r = compare(g, x, o);
  EXPECT_NEAR(r.lag_s, 0.050, 0.0002);
  EXPECT_FALSE(r.lag_within_limit);
  EXPECT_EQ(r.state, TubeState::outside);
  EXPECT_GT(r.n_outside, 1000U) << "the lag was not absorbed";
  o.remove_lag = true;
  r = compare(g, x, o);
  EXPECT_EQ(r.n_outside, 0U);
  EXPECT_EQ(r.state, TubeState::outside) << "a lag over its limit is a defect even where the shape fits";
  o.lag_limit_s = 0.060;
  EXPECT_EQ(compare(g, x, o).state, TubeState::inside);
}

TEST(Tube, NegativeTolerancesAreRefused) {
  const auto g = sine(10, 1.0);
  EXPECT_FALSE(compare_tube({0, 0.001, g}, {0, 0.001, g}, absolute(-1)));
  EXPECT_FALSE(compare_tube({0, 0.001, g}, {0, 0.001, g}, absolute(std::nan(""))));
}

}  // namespace
}  // namespace forcegate
