#include "hil/gate/conformity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hil/base/rng.h"
#include "hil/gate/rule.h"
#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

// The worked examples of JCGM 106:2012, clause 7: the numbers that the standard prints.
TEST(Jcgm106, breakdown_voltage_of_a_zener_diode) {
  EXPECT_NEAR(conformance_probability(-5.47, 0.05, {-kInf, -5.40}), 0.92, 0.005);
}

TEST(Jcgm106, bursting_pressure_of_a_metal_container) {
  EXPECT_NEAR(conformance_probability(509.7, 8.6, {490.0, kInf}), 0.99, 0.005);
}

TEST(Jcgm106, kinematic_viscosity_of_motor_oil) {
  EXPECT_NEAR(conformance_probability(13.6, 1.8, {12.5, 16.3}), 0.66, 0.005);
}

TEST(Jcgm106, a_driver_is_fined_above_107_km_per_h_where_100_are_allowed) {
  EXPECT_NEAR(guarded_rejection_limit(100.0, 0.02, 0.001), 107.0, 0.5);
}

TEST(Jcgm106, guard_bands_of_the_usual_risks) {
  EXPECT_NEAR(guard_band(1.0, 0.5), 0.0, 1e-9);
  EXPECT_NEAR(guard_band(1.0, 0.05), 1.645, 5e-4);
  EXPECT_NEAR(guard_band(1.0, 0.158655), 1.0, 1e-5);
  EXPECT_NEAR(guard_band(2.0, 0.022750132), 4.0, 1e-6);
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
    if (verdict == Verdict::pass) { EXPECT_GE(conforms, 0.9772); }
    if (verdict == Verdict::marginal) { EXPECT_TRUE(conforms >= 0.5 && conforms < 0.9773); }
    if (verdict == Verdict::inconclusive) { EXPECT_TRUE(conforms < 0.5 && conforms > 0.0227); }
    if (verdict == Verdict::fail) { EXPECT_LE(conforms, 0.0228); }
  }
}

}  // namespace
}  // namespace forcegate
