#include "hil/app/diagnose/force_character.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "hil/base/rng.h"

namespace forcegate {
namespace {

struct Readings {
  std::vector<double> t_s, force_N;
  ForceCharacter character() const { return character_of(t_s, force_N); }
};

Readings sampled(double seconds, double rate_Hz, double noise_N, double step_N, const std::function<double(double)>& force) {
  Readings out;
  Rng rng(1);
  for (int i = 0; i <= static_cast<int>(seconds * rate_Hz); ++i) {
    double F = force(i / rate_Hz) + noise_N * rng.normal();
    if (step_N > 0.0) F = std::round(F / step_N) * step_N;
    out.t_s.push_back(i / rate_Hz);
    out.force_N.push_back(F);
  }
  return out;
}

double hold(double) { return 2.25836; }
double sine_4_Hz(double t) { return 2.0 - 2.0 * std::cos(8.0 * 3.14159265 * t); }

TEST(ForceCharacter, TheScatterOfAReferenceIsNoMotionAtAnyRate) {
  const ForceCharacter asked = sampled(900.0, 200.0, 0.0, 0.0, hold).character();
  EXPECT_EQ(described(asked), "900 s, 2.26 to 2.26 N, 0 N/s on the average, 0 N/s at most");
  for (const double rate_Hz : {20.0, 200.0, 1000.0})
    for (const double noise_N : {0.005, 0.025})
      for (const double step_N : {0.0, 0.025})
        EXPECT_LT(distance(sampled(900.0, rate_Hz, noise_N, step_N, hold).character(), asked), 0.5) << rate_Hz << ' ' << noise_N << ' ' << step_N;
}

TEST(ForceCharacter, AStepThatHardlyEverComesIsNoMotionEither) {
  const auto rarely = [](double t) { return std::fmod(t, 97.0) < 0.004 ? 2.275 : 2.25; };
  EXPECT_LT(sampled(900.0, 200.0, 0.0, 0.0, rarely).character().fastest_N_per_s, 1e-6);
}

TEST(ForceCharacter, WhatIsLeftOfEqualNumbersIsNoRate) {
  const Readings r = sampled(10.0, 100.0, 0.0, 0.0, [](double t) { return t < 5.0 ? 0.3 : 0.1 + 0.2; });
  EXPECT_EQ(r.character().fastest_N_per_s, 0.0);
}

TEST(ForceCharacter, MotionStaysMotionBesideNoiseAndWithFewSamples) {
  const ForceCharacter asked = sampled(60.0, 200.0, 0.0, 0.0, sine_4_Hz).character();
  EXPECT_NEAR(asked.average_N_per_s, 32.0, 4.0);
  EXPECT_LT(distance(sampled(60.0, 200.0, 0.025, 0.025, sine_4_Hz).character(), asked), 0.5);
  EXPECT_LT(distance(sampled(60.0, 40.0, 0.0, 0.0, sine_4_Hz).character(), asked), 0.7);
  EXPECT_GT(distance(sampled(60.0, 200.0, 0.005, 0.0, hold).character(), asked), 4.0);
}

}  // namespace
}  // namespace forcegate
