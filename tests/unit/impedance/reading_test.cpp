#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "hil/base/rng.h"
#include "hil/model/impedance/bode_fit.h"
#include "rigs/emulated/dead_weight_bench.h"

namespace forcegate::test {
namespace {

using namespace impedance;

constexpr double kPi = 3.14159265358979323846;
constexpr double kRate_Hz = 320e3, kVoltsPerCode = 20.0 / 4096.0;

std::vector<std::int16_t> sine(double in_phase_V, double quadrature_V, double f_Hz, std::size_t n,
                               double noise_V, std::uint64_t seed, double clip_V = 20.0) {
  Rng rng(seed);
  std::vector<std::int16_t> out;
  for (std::size_t i = 0; i < n; ++i) {
    const double w = 2.0 * kPi * f_Hz * static_cast<double>(i) / kRate_Hz;
    const double v = std::clamp(in_phase_V * std::sin(w) + quadrature_V * std::cos(w), -clip_V, clip_V) +
                     noise_V * rng.normal();
    out.push_back(static_cast<std::int16_t>(std::lround(v / kVoltsPerCode)));
  }
  return out;
}

TEST(LockIn, finds_amplitude_and_phase_within_the_noise_that_it_states) {
  int within = 0;
  constexpr int kTrials = 400;
  for (int i = 0; i < kTrials; ++i) {
    const Phasor p = lock_in(sine(-2.0, 0.7, 4000.0, 1600, 0.02, static_cast<std::uint64_t>(i)), 4000.0,
                             kRate_Hz, kVoltsPerCode, 10.0);
    within += std::abs(p.in_phase_V + 2.0) <= 2.0 * p.u_V ? 1 : 0;
    within += std::abs(p.quadrature_V - 0.7) <= 2.0 * p.u_V ? 1 : 0;
    EXPECT_EQ(p.clipped, 0u);
  }
  EXPECT_NEAR(within / (2.0 * kTrials), 0.945, 0.03);
}

TEST(LockIn, uses_whole_periods_when_the_samples_hold_a_broken_one) {
  const Phasor p = lock_in(sine(1.0, 0.0, 4000.0, 1637, 0.0, 1), 4000.0, kRate_Hz, kVoltsPerCode, 10.0);
  EXPECT_NEAR(p.in_phase_V, 1.0, 1e-3);
  EXPECT_NEAR(p.quadrature_V, 0.0, 1e-3);
}

TEST(RcReading, recovers_resistance_and_capacitance_by_equations_6_and_7) {
  const double f = 4000.0, R = 200e3, C = 500e-12, Rg = 120e3, A = 3.0;
  const double in_phase = -A * Rg / R, quadrature = -A * Rg * 2.0 * kPi * f * C;
  const RcReading r = rc_reading({in_phase, quadrature, 0.0, 1e-4, 0.0, 0}, A, f, {Rg, 0.001, 0.0, 0.0});
  EXPECT_NEAR(r.resistance_ohm(), R, 1e-6 * R);
  EXPECT_NEAR(r.capacitance_F, C, 1e-6 * C);
  EXPECT_NEAR(r.phase_rad, std::atan(2.0 * kPi * f * C * R), 1e-9);
  EXPECT_NEAR(r.u_resistance_ohm() / R, std::hypot(1e-3, 1e-4 / A / Rg * R), 1e-5);
  EXPECT_FALSE(r.saturated);
}

TEST(RcReading, says_when_the_amplifier_saturates) {
  const Phasor clipped =
      lock_in(sine(-9.0, -9.0, 4000.0, 1600, 0.003, 3, 9.9), 4000.0, kRate_Hz, kVoltsPerCode, 9.89);
  EXPECT_TRUE(rc_reading(clipped, 3.0, 4000.0, {120e3, 0.001, 8e6, 0.1}).saturated);
  const Phasor soft =
      lock_in(sine(-9.0, -9.0, 4000.0, 1600, 0.003, 3, 8.0), 4000.0, kRate_Hz, kVoltsPerCode, 9.89);
  EXPECT_TRUE(rc_reading(soft, 3.0, 4000.0, {120e3, 0.001, 8e6, 0.1}).saturated)
      << "its third harmonic is " << soft.third_harmonic;
}

TEST(RcReading, corrects_the_phase_that_the_amplifier_turns) {
  emulated::DeadWeightOptions options;
  options.spread = false;
  options.noise = false;
  emulated::DeadWeightBench bench(options);
  ASSERT_TRUE(bench.begin({}).has_value());
  ASSERT_TRUE(bench.load(125.0, 20.0).has_value());
  std::vector<std::int16_t> codes(6400);
  ASSERT_TRUE(bench.capture(0, {WeightBenchSource::Kind::sine, 0.5, 20e3}, codes).has_value());
  const Phasor p = lock_in(codes, 20e3, kRate_Hz, kVoltsPerCode, 10.0);
  const auto truth = *bench.true_admittance_S(0, 20e3);
  const RcReading corrected = rc_reading(p, 0.5, 20e3, {120e3, 0.001, 8e6, 0.1}),
                  ideal = rc_reading(p, 0.5, 20e3, {120e3, 0.001, 0.0, 0.0});
  EXPECT_NEAR(corrected.conductance_S, truth.real(), 0.02 * truth.real());
  EXPECT_GT(std::abs(ideal.conductance_S - truth.real()),
            3.0 * std::abs(corrected.conductance_S - truth.real()));
}

TEST(RcReading, level_of_a_direct_voltage_gives_the_conductance_by_equation_8) {
  std::vector<std::int16_t> codes(640, 410);
  codes[5] = 411;
  const RcReading r = dc_reading(direct_level(codes, kVoltsPerCode, 10.0), -5.0, {120e3, 0.001, 8e6, 0.1});
  EXPECT_NEAR(r.conductance_S, 410 * kVoltsPerCode / 5.0 / 120e3, 1e-10);
  EXPECT_GT(r.u_conductance_S, 0.0009 * r.conductance_S);
}

std::vector<RcReading> sweep_of(double g, double c, double loss_Hz, double u_rel, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<RcReading> out;
  for (double f = 100.0; f < 41e3; f *= 1.12) {
    const double x = f / loss_Hz;
    RcReading r;
    r.f_Hz = f;
    r.u_conductance_S = u_rel * g, r.u_capacitance_F = u_rel * c * (1.0 + 300.0 / f);
    r.conductance_S = g * (1.0 + x * std::atan(x) * 2.0 / kPi) + r.u_conductance_S * rng.normal();
    r.capacitance_F = c + r.u_capacitance_F * rng.normal();
    out.push_back(r);
  }
  return out;
}

TEST(BodeFit, recovers_R_C_and_the_divergence_within_what_it_states) {
  int r_in = 0, c_in = 0, d_in = 0;
  constexpr int kTrials = 300;
  // x atan(x) 2/pi = 0.2 at x = 0.5897
  for (std::uint64_t seed = 0; seed < kTrials; ++seed) {
    const auto fit = fit_bode(sweep_of(3e-6, 450e-12, 9000.0, 0.004, seed));
    ASSERT_TRUE(fit.has_value()) << fit.error().to_text();
    r_in += std::abs(fit->conductance_S - 3e-6) <= 2.0 * fit->u_conductance_S ? 1 : 0;
    c_in += std::abs(fit->capacitance_F - 450e-12) <= 2.0 * fit->u_capacitance_F ? 1 : 0;
    d_in += std::abs(fit->divergence_Hz - 0.5897 * 9000.0) <= 2.0 * fit->u_divergence_Hz ? 1 : 0;
  }
  EXPECT_GT(r_in, kTrials * 0.91);
  EXPECT_GT(c_in, kTrials * 0.91);
  EXPECT_GT(d_in, kTrials * 0.91);
}

TEST(BodeFit, flags_readings_that_the_law_does_not_explain_and_no_others) {
  const auto sweep = sweep_of(3e-6, 450e-12, 9000.0, 0.004, 5);
  const auto fit = fit_bode(sweep);
  ASSERT_TRUE(fit.has_value());
  for (const RcReading& r : sweep) {
    if (r.f_Hz < 0.4 * fit->divergence_Hz) {
      EXPECT_FALSE(fit->departs(r)) << r.f_Hz;
    } else if (r.f_Hz > 1.5 * fit->divergence_Hz) {
      EXPECT_TRUE(fit->departs(r)) << r.f_Hz;
    }
  }
}

TEST(BodeFit, finds_no_divergence_where_there_is_none_and_refuses_too_few_readings) {
  const auto fit = fit_bode(sweep_of(3e-6, 450e-12, 1e9, 0.004, 6));
  ASSERT_TRUE(fit.has_value());
  EXPECT_TRUE(std::isnan(fit->divergence_Hz));
  const auto sweep = sweep_of(3e-6, 450e-12, 9000.0, 0.004, 7);
  EXPECT_FALSE(fit_bode(std::span(sweep).first(5)).has_value());
}

TEST(BodeFit, frequency_to_work_at_lies_below_every_divergence) {
  const std::vector<std::vector<RcReading>> sweeps{sweep_of(3e-6, 450e-12, 9000.0, 0.004, 8),
                                                   sweep_of(2e-6, 400e-12, 11000.0, 0.004, 9)};
  const std::vector<BodeFit> fits{*fit_bode(sweeps[0]), *fit_bode(sweeps[1])};
  const double f = operating_frequency_Hz(fits, sweeps);
  EXPECT_LT(f, 0.9 * fits[0].divergence_Hz);
  EXPECT_GT(f, 2000.0);
}

}  // namespace
}  // namespace forcegate::test
