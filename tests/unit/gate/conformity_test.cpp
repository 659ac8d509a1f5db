#include "hil/gate/conformity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "hil/base/rng.h"
#include "hil/gate/rule.h"
#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

// Nothing here rests on the library's own distribution function: a probability is the integral of the normal density
//   exp(-((x - y)/u)^2 / 2) / (u sqrt(2 pi))
// over the tolerance (JCGM 106:2012, 7.2), made by Simpson's rule. 12 u are taken for infinity (1e-32).
double integral_of_the_density(double y, double u, double low, double high) {
  low = std::max(low, y - 12.0 * u);
  high = std::min(high, y + 12.0 * u);
  constexpr int kSteps = 20000;
  const double h = (high - low) / kSteps;
  const auto density = [&](int i) {
    const double z = (low + i * h - y) / u;
    return std::exp(-0.5 * z * z) / (u * std::sqrt(2.0 * std::acos(-1.0)));
  };
  double sum = density(0) + density(kSteps);
  for (int i = 1; i < kSteps; ++i) sum += (i % 2 ? 4.0 : 2.0) * density(i);
  return sum * h / 3.0;
}

// Three cases in the manner of the standard's clause 7: an upper limit, a lower one, both. The four digits are Phi(1.4),
// Phi(2.2907) and Phi(1.5) - Phi(-0.6111) from any table of the normal distribution.
struct Example {
  const char* what;
  double y, u;
  ToleranceInterval tolerance;
  double table;
};

class Jcgm106Example : public testing::TestWithParam<Example> {};
INSTANTIATE_TEST_SUITE_P(
    Cases, Jcgm106Example,
    testing::Values(Example{"breakdown_voltage_V", -5.47, 0.05, {-kInf, -5.40}, 0.9192},
                    Example{"bursting_pressure_kPa", 509.7, 8.6, {490.0, kInf}, 0.9890},
                    Example{"viscosity_of_motor_oil_mm2_per_s", 13.6, 1.8, {12.5, 16.3}, 0.6626}),
    [](const auto& example) { return std::string(example.param.what); });

TEST_P(Jcgm106Example, the_probability_of_conformance_is_the_integral_over_the_tolerance) {
  const Example& e = GetParam();
  const double p = conformance_probability(e.y, e.u, e.tolerance);
  EXPECT_NEAR(p, integral_of_the_density(e.y, e.u, e.tolerance.low, e.tolerance.high), 1e-10);
  EXPECT_NEAR(p, e.table, 5e-5);
}

// Speed trap: u = 2 % of the reading v, and 100 km/h must be exceeded with 99.9 %. z(0.999) = 3.0902 from the table, so
// v - 3.0902 x 0.02 v = 100 and v = 106.59 km/h (the standard rounds to 107).
TEST(Jcgm106, a_driver_is_fined_above_107_km_per_h_where_100_are_allowed) {
  const double v = guarded_rejection_limit(100.0, 0.02, 0.001);
  EXPECT_NEAR(v, 100.0 / (1.0 - 3.0902 * 0.02), 1e-3);
  EXPECT_NEAR(v, 107.0, 0.5);
  EXPECT_NEAR(integral_of_the_density(v, 0.02 * v, 100.0, kInf), 0.999, 1e-9);
}

// w = z(1 - risk) u, in the standard's words w = r U with U = 2 u: r = 1 leaves 2.28 %, r = 1.645 / 2 leaves 5 %.
TEST(Jcgm106, guard_bands_of_the_usual_risks) {
  EXPECT_NEAR(guard_band(1.0, 0.5), 0.0, 1e-9);
  EXPECT_NEAR(guard_band(1.0, 0.05), 1.6449, 5e-5);
  EXPECT_NEAR(guard_band(1.0, 0.158655), 1.0, 1e-5);
  EXPECT_NEAR(guard_band(2.0, 0.022750132), 4.0, 1e-6);
  for (const double risk : {0.001, 0.02, 0.05, 0.3})
    EXPECT_NEAR(integral_of_the_density(0.0, 0.7, guard_band(0.7, risk), kInf), risk, 1e-9);
}

TEST(Jcgm106, at_the_edge_of_the_guard_band_the_risk_is_what_was_asked_for) {
  for (const double risk : {0.01, 0.0227, 0.05, 0.2}) {
    const double y = 10.0 - guard_band(0.3, risk);
    EXPECT_NEAR(1.0 - conformance_probability(y, 0.3, {-kInf, 10.0}), risk, 1e-9);
  }
}

TEST(Jcgm106, global_risks_of_a_perfect_instrument_are_none) {
  const GlobalRisks r = global_risks(0.0, 1.0, 0.0, {-1.0, 1.0}, {-1.0, 1.0});
  EXPECT_NEAR(r.consumer, 0.0, 1e-9);
  EXPECT_NEAR(r.producer, 0.0, 1e-9);
}

// With limit and acceptance limit both at the mean of the items, truth and reading are two normal numbers of correlation
// rho = sd / sqrt(sd^2 + u^2), and the chance that only one lies beyond is atan(u / sd) / (2 pi) exactly.
TEST(Jcgm106, global_risks_at_the_mean_of_the_items_are_an_angle) {
  for (const double u : {0.1, 0.25, 0.5, 1.0, 3.0}) {
    const GlobalRisks r = global_risks(7.0, 1.0, u, {-kInf, 7.0}, {-kInf, 7.0});
    const double angle = std::atan(u) / (2.0 * std::acos(-1.0));
    EXPECT_NEAR(r.consumer, angle, 1e-8) << u;
    EXPECT_NEAR(r.producer, angle, 1e-8) << u;
  }
}

// Deaver's figures for a tolerance of two standard deviations of the items and a measurement four times as good:
// 0.8 % accepted though bad, 1.5 % refused though good.
TEST(Jcgm106, global_risks_of_a_four_to_one_measurement) {
  const GlobalRisks r = global_risks(0.0, 1.0, 0.25, {-2.0, 2.0}, {-2.0, 2.0});
  EXPECT_NEAR(r.consumer, 0.008, 0.0005);
  EXPECT_NEAR(r.producer, 0.015, 0.0005);
}

// The integrals of clause 9.5 against a simulation of the same model.
TEST(Jcgm106, global_risks_agree_with_a_simulation) {
  const double mean = 1500.0, sd = 0.12, u = 0.04;
  const ToleranceInterval tolerance{1499.8, 1500.2}, acceptance{1499.82, 1500.18};
  Rng rng(106, "jcgm");
  constexpr int kN = 400000;
  int consumer = 0, producer = 0;
  for (int i = 0; i < kN; ++i) {
    const double truth = rng.normal(mean, sd), reading = rng.normal(truth, u);
    const bool conforms = truth >= tolerance.low && truth <= tolerance.high;
    const bool accepted = reading >= acceptance.low && reading <= acceptance.high;
    consumer += accepted && !conforms;
    producer += !accepted && conforms;
  }
  const GlobalRisks r = global_risks(mean, sd, u, tolerance, acceptance);
  EXPECT_NEAR(r.consumer, consumer / double{kN}, 4.0 * std::sqrt(r.consumer / kN));
  EXPECT_NEAR(r.producer, producer / double{kN}, 4.0 * std::sqrt(r.producer / kN));
}

TEST(Jcgm106, narrower_acceptance_trades_the_consumer_s_risk_for_the_producer_s) {
  const ToleranceInterval tolerance{-2.0, 2.0};
  GlobalRisks last = global_risks(0.0, 1.0, 0.25, tolerance, tolerance);
  for (const double w : {0.1, 0.25, 0.5}) {
    const GlobalRisks r = global_risks(0.0, 1.0, 0.25, tolerance, {-2.0 + w, 2.0 - w});
    EXPECT_LT(r.consumer, last.consumer);
    EXPECT_GT(r.producer, last.producer);
    last = r;
  }
}

// The rule of the plan is guarded acceptance with w = U = 2 u: a pass has at most 2.3 % risk, a fail at least 97.7 %.
TEST(Jcgm106, the_zones_of_the_rule_are_guard_bands_of_two_standard_uncertainties) {
  Rng rng(7, "zones");
  for (int i = 0; i < 2000; ++i) {
    Check c;
    c.limit = {Limit::Kind::upper, 4.5, "test"};
    c.u = 0.05 + rng.uniform();
    c.value = 4.5 + 3.0 * c.u * (2.0 * rng.uniform() - 1.0);
    const double conforms = conformance_probability(c.value, c.u, {-kInf, 4.5});
    const Verdict verdict = zone(c, coverage_factor(0.9545, 0.0) * c.u);
    if (verdict == Verdict::pass) {
      EXPECT_GE(conforms, 0.9772);
    }
    if (verdict == Verdict::marginal) {
      EXPECT_TRUE(conforms >= 0.5 && conforms < 0.9773);
    }
    if (verdict == Verdict::inconclusive) {
      EXPECT_TRUE(conforms < 0.5 && conforms > 0.0227);
    }
    if (verdict == Verdict::fail) {
      EXPECT_LE(conforms, 0.0228);
    }
  }
}

}  // namespace
}  // namespace forcegate
