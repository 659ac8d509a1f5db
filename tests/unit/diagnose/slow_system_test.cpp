// One recording of a machine that follows its input late, by much.

#include <numbers>

#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

using Series = std::vector<double>;

// Levels that last `hold_s` each, between 0.5 and 4.5.
std::function<double(double)> steps(double hold_s, std::uint64_t seed) {
  return [=](double t) {
    Rng rng(seed + static_cast<std::uint64_t>(t / hold_s), "levels");
    return 0.5 + 4.0 * rng.uniform();
  };
}

Series low_pass(const Series& t, const Series& x, double tau_s) {
  Series y(x.size(), x.front());
  for (std::size_t i = 1; i < x.size(); ++i) y[i] = y[i - 1] + (x[i - 1] - y[i - 1]) * -std::expm1(-(t[i] - t[i - 1]) / tau_s);
  return y;
}

Series late_by(const Series& x, std::size_t samples) {
  Series y(x.size(), x.front());
  for (std::size_t i = samples; i < x.size(); ++i) y[i] = x[i - samples];
  return y;
}

// A mass on a spring that the input moves.
Series resonant(const Series& t, const Series& x, double f_Hz, double damping) {
  constexpr int kSteps = 16;
  const double omega = 2.0 * std::numbers::pi * f_Hz;
  Series y(x.size());
  double s = x.front(), v = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dt = (t[1] - t[0]) / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      v += (omega * omega * (x[i] - s) - 2.0 * damping * omega * v) * dt;
      s += v * dt;
    }
    y[i] = 0.4 * s;
  }
  return y;
}

Series straight_line(Series x) {
  for (double& v : x) v = 0.1 + 0.5 * v;
  return x;
}

const Finding& first(const Diagnosis& d) {
  static const Finding none;
  return d.findings.empty() ? none : d.findings.front();
}

double value_of(const Finding& f, const std::string& name) {
  const auto found = std::ranges::find(f.parameters, name, &FoundParameter::name);
  return found == f.parameters.end() ? 0.0 : found->value;
}

// A heat exchanger: nothing of the input is there at once. Its output grows long after every step, and none of it is creep.
TEST(SlowSystem, ADeadTimeAndALagOfManySecondsAreNoCreep) {
  const Diagnosis d = answer(recording(1.0, 4000, steps(60.0, 5), [](const Series& t, const Series& x) { return straight_line(low_pass(t, late_by(x, 12), 20.0)); }, 0.003));
  EXPECT_EQ(first(d).effect, "lag") << told(d);
  EXPECT_GE(first(d).probability, 0.5) << told(d);
  for (const Finding& f : d.findings) EXPECT_FALSE(f.effect == "creep" && f.claimed()) << told(d);
}

TEST(SlowSystem, ALagBehindABentCurveIsNoCreep) {
  const Diagnosis d = answer(recording(100.0, 20000, steps(3.0, 7), [](const Series& t, const Series& x) {
    Series y = low_pass(t, x, 2.0);
    for (double& v : y) v = 7.0 + 3.0 * std::tanh(1.2 * (v - 2.5));
    return y;
  }, 0.02));
  EXPECT_EQ(first(d).effect, "lag") << told(d);
  for (const Finding& f : d.findings) EXPECT_FALSE(f.effect == "creep" && f.claimed()) << told(d);
}

// The same in several files without a word about them.
TEST(SlowSystem, AFolderOfFilesThatNobodyDescribedMayBeASlowMachineToo) {
  Campaign c;
  for (std::uint64_t k = 0; k < 3; ++k) {
    Campaign one = recording(50.0, 8000, steps(6.0, 21 + 100 * k), [](const Series& t, const Series& x) { return straight_line(low_pass(t, x, 3.0)); }, 0.003);
    one.records.front().name = "r" + std::to_string(k);
    c.records.push_back(std::move(one.records.front()));
  }
  c.name = "folder";
  const Diagnosis d = answer(std::move(c));
  EXPECT_EQ(first(d).effect, "lag") << told(d);
  EXPECT_TRUE(first(d).claimed()) << told(d);
  EXPECT_NEAR(value_of(first(d), "lag_s"), 3.0, 0.1) << told(d);
}

// Behind a ramp that ends before the lag is over, it would be told as less.
TEST(SlowSystem, ALagOfAMinuteIsToldWithItsTime) {
  const Diagnosis d = answer(recording(10.0, 9000, steps(90.0, 11), [](const Series& t, const Series& x) { return straight_line(low_pass(t, x, 60.0)); }, 0.003));
  EXPECT_EQ(first(d).effect, "lag") << told(d);
  EXPECT_NEAR(value_of(first(d), "lag_s"), 60.0, 1.0) << told(d);
}

// The other way round: most of the load is answered at once, and the rest grows with one time constant of some seconds.
TEST(SlowSystem, AShareThatFollowsLateIsCreep) {
  const Diagnosis d = answer(recording(50.0, 15000, steps(20.0, 9), [](const Series& t, const Series& x) {
    Series y = low_pass(t, x, 8.0);
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = 0.1 + 0.5 * (x[i] + 0.06 * y[i]);
    return y;
  }, 0.002));
  EXPECT_EQ(first(d).effect, "creep") << told(d);
  EXPECT_GE(first(d).probability, 0.5) << told(d);
}

// Two loggers that were started by hand. At 20 Hz an edge lies between two samples, at 200 Hz it does not.
TEST(SlowSystem, AnOutputThatIsLateAsAWholeIsDelayed) {
  for (const auto& [rate_Hz, late_s] : {std::pair{20.0, 0.1}, std::pair{20.0, 0.5}, std::pair{20.0, 1.0}, std::pair{200.0, 0.3}}) {
    const auto slow = [edges = steps(4.0, 11)](double t) { return edges(t) + 0.3 * std::sin(0.9 * t); };
    const auto samples = static_cast<std::size_t>(std::lround(late_s * rate_Hz));
    const Diagnosis d = answer(recording(rate_Hz, 12000, slow, [&](const Series&, const Series& x) { return straight_line(late_by(x, samples)); }, 0.002));
    EXPECT_EQ(first(d).effect, "delay") << rate_Hz << " Hz, " << late_s << " s: " << told(d);
    EXPECT_GE(first(d).probability, 0.5) << told(d);
    EXPECT_NEAR(value_of(first(d), "delay_s"), late_s, 0.02 * late_s) << told(d);
  }
}

TEST(SlowSystem, AResonanceHasNoName) {
  const Diagnosis d = answer(recording(100.0, 20000, steps(5.0, 13), [](const Series& t, const Series& x) { return resonant(t, x, 2.0, 0.15); }, 0.004));
  for (const Finding& f : d.findings) EXPECT_FALSE(f.claimed()) << told(d);
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown);
  EXPECT_NE(std::ranges::find(d.follows, "a resonance"), d.follows.end()) << told(d);
}

// The bits of an output that hardly follows the input tell the output itself, to the last digit that was written.
TEST(SlowSystem, AnOutputThatHardlyFollowsHasNoCodes) {
  const auto binary = [](double t) {
    Rng rng(17 + static_cast<std::uint64_t>(t / 0.4), "binary");
    return rng.uniform() < 0.5 ? 3.4 : 6.4;
  };
  Campaign c = recording(12.5, 1000, binary, [](const Series& t, const Series& x) { return low_pass(t, low_pass(t, late_by(x, 3), 0.25), 0.25); }, 0.03);
  for (double& v : c.records.front().trace.find("U")->value) v = std::round(v * 1e5) / 1e5;
  const Diagnosis d = answer(std::move(c));
  for (const Finding& f : d.findings) EXPECT_FALSE(f.effect == "adc_codes" && f.claimed()) << told(d);
}

// What a model holds is no candidate: a form that falls short must not pass for nothing.
TEST(SlowSystem, AFormOfTheModelThatFallsShortIsNoNone) {
  const auto with_dead_time = recording(1.0, 4000, steps(60.0, 5), [](const Series& t, const Series& x) { return straight_line(low_pass(t, late_by(x, 12), 20.0)); }, 0.003);
  const EffectKind& lag = *EffectRegistry::instance().find("lag");
  EngineOptions options;
  options.threads = 1;
  options.in_model = {"lag"};
  const auto one_pole = std::ranges::find(lag.forms, "one_pole", &EffectForm::name);
  ASSERT_NE(one_pole, lag.forms.end());
  options.model_effects = {model_effect(lag, *one_pole, std::vector{30.0}, std::vector{Estimate{1.0, 0.01}})};
  auto d = diagnose_campaign(with_dead_time, options);
  ASSERT_TRUE(d.has_value()) << d.error().to_text();
  EXPECT_NE(d->verdict, DiagnosisVerdict::none) << told(*d);
}

// A lightly damped mass at 70 Hz under a load as fast: means of 50 rows a second show neither.
TEST(SlowSystem, WhatIsFasterThanFiftyRowsASecondIsSeen) {
  const auto shaken = [](double t) {
    double sum = 3.0;
    for (int k = 0; k < 14; ++k) sum += 0.3 * std::sin(2.0 * std::numbers::pi * (15.0 + 7.3 * k) * t + 2.4 * k * k);
    return sum;
  };
  const Diagnosis d = answer(recording(600.0, 30000, shaken, [](const Series& t, const Series& x) { return resonant(t, x, 70.0, 0.05); }, 0.004));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
}

// A circuit at the rate of a sound card: its time constant is a twentieth of the shortest that a force sensor has.
TEST(SlowSystem, ALagOfMicrosecondsIsSeenWhereTheLoadIsAsFast) {
  const auto shaken = [](double t) {
    double sum = 2.5;
    for (int k = 0; k < 12; ++k) sum += 0.15 * std::sin(2.0 * std::numbers::pi * (60.0 + 311.7 * k) * t + 2.4 * k * k);
    return sum;
  };
  const Diagnosis d = answer(recording(51200.0, 40000, shaken, [](const Series& t, const Series& x) { return straight_line(low_pass(t, x, 6e-5)); }, 0.002));
  EXPECT_EQ(first(d).effect, "lag") << told(d);
  EXPECT_TRUE(first(d).claimed()) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
