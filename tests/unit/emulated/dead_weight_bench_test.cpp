#include "rigs/emulated/dead_weight_bench.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace forcegate::test {
namespace {

using namespace emulated;

double mean_V(DeadWeightBench& bench, std::size_t sensor, const WeightBenchSource& source) {
  std::vector<std::int16_t> codes(6400);
  EXPECT_TRUE(bench.capture(sensor, source, codes).has_value());
  double sum = 0;
  for (const auto c : codes) sum += c;
  return sum / static_cast<double>(codes.size()) * bench.info().volts_per_code();
}

double phase_deg(const RcSensor& s, double f_Hz) { return std::arg(s.admittance_S(f_Hz)) * 180.0 / std::numbers::pi; }
double rc_phase_deg(const RcSensor& s, double f_Hz) {
  const RcState at = s.state();
  return std::atan(2.0 * std::numbers::pi * f_Hz * at.capacitance_F / at.conductance_S) * 180.0 / std::numbers::pi;
}

TEST(DeadWeightBench, direct_voltage_shows_the_conductance_by_equation_8) {
  DeadWeightBench bench({});
  ASSERT_TRUE(bench.begin({.seed = 3}).has_value());
  for (const double force : {50.0, 125.0, 250.0}) {
    ASSERT_TRUE(bench.load(force, 20.0).has_value());
    const double expected = 5.0 * 120e3 * bench.sensor(2).state().conductance_S;
    EXPECT_NEAR(mean_V(bench, 2, {}), expected, 0.003 * expected + 0.005) << force;
  }
}

TEST(DeadWeightBench, phase_follows_the_RC_law_up_to_the_divergence_and_saturates_beyond) {
  for (std::uint64_t sensor = 0; sensor < 8; ++sensor) {
    const RcSpecimen p = draw_rc_specimen(11, 0, sensor);
    RcSensor s;
    s.begin(p, Rng(1), 7200.0);
    s.load(125.0, 20.0);
    EXPECT_NEAR(phase_deg(s, 1000.0), rc_phase_deg(s, 1000.0), 1.0);
    EXPECT_NEAR(rc_phase_deg(s, p.divergence_Hz) - phase_deg(s, p.divergence_Hz), 3.0, 2.0);
    EXPECT_GT(std::tan(rc_phase_deg(s, 40e3) * std::numbers::pi / 180.0) / std::tan(phase_deg(s, 40e3) * std::numbers::pi / 180.0),
              3.0);
    EXPECT_NEAR(phase_deg(s, 40e3), phase_deg(s, 15e3), 5.0);
    // Fig. 8 and Fig. 7: the resistance falls dramatically, the capacitance varies little
    const auto low = s.admittance_S(1000.0), high = s.admittance_S(40e3);
    EXPECT_LT(low.real() / high.real(), 0.4);
    EXPECT_GT(high.imag() / 40.0 / low.imag(), 0.6);
  }
}

TEST(DeadWeightBench, admittance_is_passive_and_its_capacitance_falls_where_its_loss_grows) {
  RcSensor s;
  s.begin(draw_rc_specimen(5, 1, 4), Rng(2), 7200.0);
  s.load(200.0, 20.0);
  double before_S = 0.0, before_F = 1.0;
  for (double f = 100.0; f < 60e3; f *= 1.3) {
    const auto y = s.admittance_S(f);
    EXPECT_GT(y.real(), before_S);
    EXPECT_LT(y.imag() / (2.0 * std::numbers::pi * f), before_F);
    before_S = y.real();
    before_F = y.imag() / (2.0 * std::numbers::pi * f);
  }
}

TEST(DeadWeightBench, large_sines_clip_at_the_rails) {
  DeadWeightBench bench({});
  ASSERT_TRUE(bench.begin({}).has_value());
  ASSERT_TRUE(bench.load(250.0, 20.0).has_value());
  std::vector<std::int16_t> codes(1600);
  ASSERT_TRUE(bench.capture(0, {WeightBenchSource::Kind::sine, 3.0, 40e3}, codes).has_value());
  EXPECT_GT(std::count_if(codes.begin(), codes.end(), [](int c) { return std::abs(c) > 2040; }), 200);
  ASSERT_TRUE(bench.capture(0, {WeightBenchSource::Kind::sine, 0.5, 40e3}, codes).has_value());
  EXPECT_EQ(std::count_if(codes.begin(), codes.end(), [](int c) { return std::abs(c) > 2040; }), 0);
}

TEST(DeadWeightBench, conductance_repeats_less_well_than_capacitance) {
  double g_N2 = 0, c_N2 = 0;
  int below = 0;
  constexpr int kSensorsTried = 200, kLoadings = 8;
  for (int sensor = 0; sensor < kSensorsTried; ++sensor) {
    const RcSpecimen p = draw_rc_specimen(21, 7, static_cast<std::uint64_t>(sensor));
    std::vector<double> g, c;
    for (std::uint64_t loading = 0; loading < kLoadings; ++loading) {
      RcSensor s;
      s.begin(p, Rng(loading, "sensor" + std::to_string(sensor)), 7200.0);
      for (double force = 5.0; force <= 150.0; force += 5.0) s.load(force, 20.0);
      g.push_back(s.state().conductance_S / p.g_S_per_N);
      c.push_back(s.state().capacitance_F / p.c_F_per_N);
    }
    const auto variance = [](const std::vector<double>& v) {
      double m = 0, q = 0;
      for (const double x : v) m += x / kLoadings;
      for (const double x : v) q += (x - m) * (x - m) / (kLoadings - 1);
      return q;
    };
    g_N2 += variance(g) / kSensorsTried;
    c_N2 += variance(c) / kSensorsTried;
    below += variance(c) < variance(g) ? 1 : 0;
  }
  EXPECT_NEAR(std::sqrt(g_N2), 0.68, 0.12);
  EXPECT_NEAR(std::sqrt(c_N2), 0.36, 0.06);
  EXPECT_GT(below, kSensorsTried * 3 / 4);
}

TEST(DeadWeightBench, same_seed_gives_the_same_samples_and_another_loading_others) {
  const auto samples = [](std::uint64_t loading) {
    DeadWeightBench bench({});
    EXPECT_TRUE(bench.begin({.seed = 4, .set = 2, .loading = loading}).has_value());
    EXPECT_TRUE(bench.load(100.0, 20.0).has_value());
    std::vector<std::int16_t> codes(400);
    EXPECT_TRUE(bench.capture(5, {WeightBenchSource::Kind::sine, 3.0, 4000.0}, codes).has_value());
    return codes;
  };
  EXPECT_EQ(samples(0), samples(0));
  EXPECT_NE(samples(0), samples(1));
}

TEST(DeadWeightBench, refuses_what_it_cannot_do) {
  DeadWeightBench bench({});
  EXPECT_FALSE(bench.load(10.0, 1.0).has_value());
  ASSERT_TRUE(bench.begin({}).has_value());
  EXPECT_FALSE(bench.load(255.0, 1.0).has_value());
  std::vector<std::int16_t> codes(16);
  EXPECT_FALSE(bench.capture(8, {}, codes).has_value());
  EXPECT_FALSE(bench.capture(0, {WeightBenchSource::Kind::sine, 1.0, 160e3}, codes).has_value());
}

}  // namespace
}  // namespace forcegate::test
