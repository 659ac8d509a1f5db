// What changes with the time within one recording, and is no effect of the sensor.

#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

using Course = std::function<double(double share_of_recording)>;

double sine(double t) { return 2.0 - 1.2 * std::cos(6.283185307179586 * t); }
double triangles(double t) { return 2.0 + 2.0 * std::abs(std::fmod(t / 30.0, 2.0) - 1.0); }

// U = gain F + zero, both moving.
Diagnosis answer_to(const std::function<double(double)>& force, const Course& gain, const Course& zero) {
  return answer(recording(50.0, 30000, force, [&](const std::vector<double>& t, const std::vector<double>& F) {
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i) U.push_back(gain(t[i] / t.back()) * F[i] + zero(t[i] / t.back()));
    return U;
  }, 0.003));
}

void expect_no_claim(const Diagnosis& d) {
  for (const Finding& f : d.findings) EXPECT_LT(f.probability, 0.5) << f.effect << '\n' << told(d);
}

// Either way: what grows with time and knows nothing of the load is no creep.
TEST(InTime, AZeroThatGoesInALineIsNoCreep) {
  for (const double drift_V : {0.06, -0.06})
    expect_no_claim(answer_to(triangles, [](double) { return 2.0; }, [&](double x) { return 0.5 + drift_V * x; }));
}

TEST(InTime, AGainThatRisesInALineIsNoSelfHeating) {
  const Diagnosis d = answer_to(sine, [](double x) { return 2.0 * (1.0 + 0.1 * x); }, [](double) { return 0.2; });
  expect_no_claim(d);
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
  EXPECT_EQ(d.follows, std::vector<std::string>{"a gain that goes with the time"}) << told(d);
}

// A load cell that was knocked, an amplifier that changed its range; nor is what stands beside it for a part of the jump.
TEST(InTime, AJumpIsNeitherCreepNorLag) {
  const auto after = [](double x, double at) { return x >= at ? 1.0 : 0.0; };
  const Diagnosis zero = answer_to(sine, [](double) { return 2.0; }, [&](double x) { return 0.2 - 0.25 * after(x, 0.5); });
  const Diagnosis gain = answer_to(triangles, [&](double x) { return 2.0 - 0.2 * after(x, 0.31); }, [](double) { return 0.2; });
  const std::string jump = "a jump of zero or gain at one moment, after about ";
  for (const auto& [d, at_s] : {std::pair{&zero, 300.0}, std::pair{&gain, 186.0}}) {
    expect_no_claim(*d);
    EXPECT_EQ(d->verdict, DiagnosisVerdict::unknown) << told(*d);
    EXPECT_TRUE(d->not_separable.empty()) << told(*d);
    ASSERT_EQ(d->follows.size(), 1u) << told(*d);
    ASSERT_TRUE(d->follows.front().starts_with(jump)) << d->follows.front();
    EXPECT_NEAR(std::stod(d->follows.front().substr(jump.size())), at_s, 10.0);
  }
}

// A loss of a tenth is within what the base law may do, and how much that is of the swing (0.8 to 3.2 N, 0.32 of 2.4 N) is said.
TEST(InTime, HowMuchTheSwingLosesIsTold) {
  const Diagnosis d = answer_to(sine, [](double x) { return 2.0 * (1.0 - 0.1 * x); }, [](double) { return 0.2; });
  const std::string begin = "its swing goes down to ";
  const auto note = std::ranges::find_if(d.notes, [&](const std::string& n) { return n.starts_with(begin); });
  ASSERT_NE(note, d.notes.end()) << told(d);
  EXPECT_NEAR(std::stod(note->substr(begin.size())), 86.7, 3.0) << *note;
}

// Every part of one recording is asked; what takes a thousandth off its error is no finding.
TEST(InTime, WhatHardlyHelpsIsNoClaim) {
  const Diagnosis d = answer_to(sine, [](double x) { return 2.0 * std::exp(-0.3 * x); }, [](double) { return 0.2; });
  for (const Finding& f : d.findings)
    if (f.claimed()) { EXPECT_LT(f.error_after, 0.995 * f.error_before) << f.effect; }
}

}  // namespace
}  // namespace forcegate::diagnose
