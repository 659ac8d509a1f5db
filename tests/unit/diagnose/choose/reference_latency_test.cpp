#include <algorithm>
#include <array>
#include <numbers>

#include "hil/diagnose/choose/reference_latency.h"
#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

// Edges of 50 ms once a second between levels that climb and fall: the output leads by `lead_s(F)`. `creep`: growth per decade, relaxations
// from 0.1 s on.
Campaign edges(std::uint64_t seed, const std::function<double(double F)>& lead_s, double creep = 0.0) {
  Campaign c = make_campaign(seed, straight);
  Rng rng(seed, "edges");
  for (Record& r : c.records) {
    auto& F = r.trace.find("F_ref")->value;
    auto& U = r.trace.find("U")->value;
    const double high = rng.uniform(2.0, 4.0), low = rng.uniform(0.3, 1.5);
    const auto force = [&](double t) {
      const double x = t - std::floor(t);
      const double mean = low + 0.5 * std::abs(std::fmod(t / 20.0, 2.0) - 1.0);
      return mean + (high - mean) * std::clamp(std::min(x, 0.5 + 0.05 - x) / 0.05, 0.0, 1.0);
    };
    std::array<double, 5> slow{};
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double t = static_cast<double>(i) / 200.0;
      const double f = force(t), rate = (force(t + 1e-3) - force(t - 1e-3)) / 2e-3;
      double tau_s = 0.1, grown = 0.0;
      for (double& s : slow) {
        s += (f - s) * -std::expm1(-0.005 / tau_s);
        grown += creep * s;
        tau_s *= 10.0;
      }
      F[i] = std::round((f + 0.006 * rng.normal()) / 0.025) * 0.025;
      U[i] = std::clamp(2.0 * (f + grown + lead_s(f) * rate) + 0.2 + 0.004 * rng.normal(), 0.0, 10.0);
    }
    r.kind = "steps";
  }
  return c;
}

double shift_of(TimeShift shift) {
  EffectKind kind;
  kind.traits.timing = true;
  kind.traits.shift = shift;
  EffectForm form;
  ResidualChannel channel;
  channel.candidates.push_back({&kind, &form, {0.5}, 0, 1});
  channel.variants.push_back({0, {0}});
  FamilyScore family;
  family.kind = &kind;
  family.best.variant = 0;
  family.best.fit.coefficient = Eigen::VectorXd::Constant(1, -2.0);
  return shift_s(channel, family);
}

TEST(ReferenceLatency, AnEffectOfTimeShiftsByWhatItsTraitsSay) {
  EXPECT_EQ(shift_of(TimeShift::none), 0.0);
  EXPECT_EQ(shift_of(TimeShift::first_shape), 1.0);
  EXPECT_EQ(shift_of(TimeShift::percent_lead), 0.02);
}

TEST(ReferenceLatency, ALeadThatIsTheSameAtEveryLoadIsTheReferences) {
  const Diagnosis d = answer(edges(61, [](double) { return 0.005; }));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
}

TEST(ReferenceLatency, AShiftThatIsLeftToTheClocksIsListedWithItsSize) {
  const Diagnosis d = answer(edges(61, [](double) { return 0.005; }));
  ASSERT_EQ(d.findings.size(), 1u) << told(d);
  const Finding& f = d.findings.front();
  EXPECT_EQ(f.effect, "delay");
  EXPECT_LT(f.probability, 0.3);
  ASSERT_EQ(f.parameters.size(), 1u);
  EXPECT_NEAR(f.parameters.front().value, -0.005, 3.0 * f.parameters.front().u + 0.0005) << "negative: the output leads";
  EXPECT_LT(f.error_after, 0.7 * f.error_before);
  EXPECT_EQ(probability(answer(edges(61, [](double) { return 0.0; })), "delay"), 0.0) << "in step";
}

// The force of all records behind a pole of tau_s, or as it was delay_s before, is what the reference says.
Campaign late_reference(std::uint64_t seed, double tau_s, double delay_s) {
  Campaign c = make_campaign(seed, straight);
  for (Record& r : c.records) {
    auto& F = r.trace.find("F_ref")->value;
    const std::vector<double> now = F;
    const auto samples = static_cast<std::ptrdiff_t>(std::lround(200.0 * delay_s));
    double y = now[0];
    for (std::ptrdiff_t i = 0; i < std::ssize(F); ++i) {
      const double in = now[static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, i - samples))];
      y += tau_s > 0.0 ? (in - y) * -std::expm1(-0.005 / tau_s) : in - y;
      F[static_cast<std::size_t>(i)] = std::round(y / 0.025) * 0.025;
    }
  }
  return c;
}

TEST(ReferenceLatency, ALeadOfATwentiethOfASecondIsNotForgivenAndItsSizeIsTold) {
  const Diagnosis d = answer(late_reference(3, 0.05, 0.0));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
  EXPECT_NE(told(d).find("the output leads the reference by about "), std::string::npos) << told(d);
}

TEST(ReferenceLatency, AReferenceThatIsADelayOfATenthBehindIsADelay) {
  const Diagnosis d = answer(late_reference(3, 0.0, 0.1));
  ASSERT_FALSE(d.findings.empty()) << told(d);
  EXPECT_EQ(d.findings.front().effect, "delay") << told(d);
  ASSERT_FALSE(d.findings.front().parameters.empty());
  EXPECT_NEAR(d.findings.front().parameters.front().value, -0.1, 0.005);
}

Diagnosis answer_of_declared(double corner_Hz, Campaign c) {
  c.bench.reference_lowpass_Hz = corner_Hz;
  return answer(std::move(c));
}

TEST(ReferenceLatency, ALowpassThatTheBenchDeclaresOfTheReferenceIsNoFinding) {
  const Diagnosis d = answer_of_declared(3.183, late_reference(3, 0.05, 0.0));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_NE(told(d).find("the output is taken through the low-pass of 3.18 Hz"), std::string::npos) << told(d);
  EXPECT_EQ(told(d).find("leads the reference by about "), std::string::npos) << told(d);
  EXPECT_LT(d.error_after, 1.3 * d.floor) << told(d);
}

TEST(ReferenceLatency, WhatALowpassOfHigherOrderIsLateByBeyondOnePoleIsItsOwn) {
  const Diagnosis d = answer_of_declared(1.0 / (2.0 * std::numbers::pi * 0.02), late_reference(3, 0.02, 0.02));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
}

TEST(ReferenceLatency, ADelayThatNoDeclaredLowpassHasIsADelay) {
  const Diagnosis d = answer_of_declared(20.0, late_reference(3, 0.0, 0.1));
  ASSERT_FALSE(d.findings.empty()) << told(d);
  EXPECT_EQ(d.findings.front().effect, "delay") << told(d);
}

// U = g (F + tau dF/dt) is what a load cell behind a pole of 80 ms makes of a straight sensor: whatever is named for it, the lead is told.
TEST(ReferenceLatency, AReferenceBehindAPoleIsToldBesideWhatAnswersToTheRate) {
  const auto presses = [](double t) { return 1.5 + 0.8 * std::sin(2.1 * t) + 0.5 * std::sin(5.3 * t + 1.0) + 0.3 * std::sin(0.13 * t); };
  const Diagnosis d = answer(recording(50.0, 15000, presses, [](const std::vector<double>& t, const std::vector<double>& F) {
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const std::size_t a = i > 0 ? i - 1 : i, b = i + 1 < F.size() ? i + 1 : i;
      U.push_back(2.0 * (F[i] + 0.08 * (F[b] - F[a]) / (t[b] - t[a])) + 0.2);
    }
    return U;
  }, 0.003));
  const std::string text = told(d), begin = "the output leads the reference by about ";
  ASSERT_NE(text.find(begin), std::string::npos) << text;
  EXPECT_NEAR(std::stod(text.substr(text.find(begin) + begin.size())), 75.0, 15.0) << text;
  EXPECT_EQ(text.find("out of step by a few milliseconds"), std::string::npos) << text;
}

// A loop alone would pass for a lead of many milliseconds, so that the lateness shows beside it only.
TEST(ReferenceLatency, WhatShowsBesideALoopOnlyIsInNoErrorOfTheModel) {
  Campaign c = make_campaign(5, [](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    double play = F[0];
    for (const double f : F) {
      play = std::min(std::max(play, f - 0.3), f + 0.3);
      U.push_back(2.0 * (f + 0.5 * play) + 0.2);
    }
    return U;
  });
  for (std::size_t k = 0; k < c.records.size(); k += 2) {  // fast edges in every other record
    auto& F = c.records[k].trace.find("F_ref")->value;
    auto& U = c.records[k].trace.find("U")->value;
    Rng rng(k, "edges");
    double play = 1.0, late = 1.0;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double x = std::fmod(static_cast<double>(i) / 200.0, 2.0), f = 1.0 + 2.5 * std::clamp(std::min(x, 1.2 - x) / 0.2, 0.0, 1.0);
      play = std::min(std::max(play, f - 0.3), f + 0.3);
      late += (f - late) * -std::expm1(-0.005 / 0.006);
      U[i] = 2.0 * (f + 0.5 * play) + 0.2 + 0.004 * rng.normal();
      F[i] = std::round((late + 0.006 * rng.normal()) / 0.025) * 0.025;
    }
  }
  const Diagnosis d = answer(std::move(c));
  ASSERT_FALSE(d.findings.empty()) << told(d);
  EXPECT_EQ(d.findings.front().effect, "hysteresis") << told(d);
  EXPECT_NE(told(d).find("leads the reference by a few milliseconds"), std::string::npos) << told(d);
  EXPECT_LT(d.error_after, 1.3 * d.floor);
}

TEST(ReferenceLatency, ALeadThatFadesWithTheLoadIsTheSensors) {
  const Diagnosis d = answer(edges(61, [](double F) { return 0.012 * std::exp(-F / 1.5); }));
  ASSERT_FALSE(d.findings.empty()) << told(d);
  EXPECT_EQ(d.findings.front().effect, "piezocapacitance") << told(d);
  EXPECT_GE(d.findings.front().probability, 0.5) << told(d);
}

// C = C1 F/(F + F0): nearly all of the charge moves at the first tenths of a newton.
TEST(ReferenceLatency, ALeadThatFadesQuicklyHasOneStrength) {
  const Diagnosis d = answer(edges(61, [](double F) { return 0.06 / ((1.0 + F / 0.4) * (1.0 + F / 0.4)); }));
  ASSERT_FALSE(d.findings.empty()) << told(d);
  EXPECT_EQ(d.findings.front().effect, "piezocapacitance") << told(d);
  EXPECT_GE(d.findings.front().probability, 0.9) << told(d);
  EXPECT_EQ(d.findings.front().form, "fading") << told(d);
  EXPECT_LT(d.error_after, 1.2 * d.floor) << told(d);
}

TEST(ReferenceLatency, ALeadThatGrowsWithTheLoadIsNoDisplacementCurrent) {
  const Diagnosis d = answer(edges(61, [](double F) { return 0.0015 * F; }));
  for (const Finding& f : d.findings) EXPECT_TRUE(f.effect != "piezocapacitance" || f.probability < 0.5) << told(d);
}

// The slow growth is the larger one and comes first; a lead of the reference's own is carried along beside it.
TEST(ReferenceLatency, ALeadThatFadesWithTheLoadIsTheSensorsBesideCreepToo) {
  for (const std::uint64_t seed : {62, 64}) {
    const Diagnosis d = answer(edges(seed, [](double F) { return 0.002 + 0.01 * std::exp(-F / 1.0); }, 0.03));
    EXPECT_GE(probability(d, "creep"), 0.5) << seed << "\n" << told(d);
    EXPECT_GE(probability(d, "piezocapacitance"), 0.5) << seed << "\n" << told(d);
  }
}

}  // namespace
}  // namespace forcegate::diagnose
