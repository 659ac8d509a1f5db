// The noise of samples of which some are missing in a regular pattern.

#include "hil/diagnose/raw/sample_noise.h"

#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

const double kMissingSample = std::nan("");

TEST(SampleNoise, IsTheSameWhereEveryThirdSampleIsMissing) {
  Rng rng(3, "noise");
  std::vector<double> t, x;
  for (int i = 0; i < 30000; ++i) {
    t.push_back(0.01 * i);
    x.push_back(std::sin(0.4 * t.back()) + 0.002 * rng.normal());
  }
  for (const std::size_t every : {2u, 3u, 4u}) {
    std::vector<double> some = x;
    for (std::size_t i = 0; i < some.size(); i += every) some[i] = kMissingSample;
    EXPECT_NEAR(white_noise(some), 0.002, 1.5e-4) << every;
    EXPECT_NEAR(restless_noise(t, some), 0.002, 1.5e-4) << every;
  }
  EXPECT_NEAR(noise_between_missing(x), white_noise(x), 1e-5);
}

TEST(SampleNoise, OfALongHoleIsNoNeighbour) {
  std::vector<double> x(4000, kMissingSample);
  for (std::size_t i = 0; i < x.size(); i += 100) x[i] = static_cast<double>(i % 700);
  EXPECT_EQ(noise_between_missing(x), 0.0);
}

// 12000 rows: a stride over them that is three long meets the missing ones alone.
Campaign missing(const char* channel, std::size_t every) {
  Campaign c = recording(20.0, 12000, [](double t) { return 2.0 + std::sin(0.3 * t) + 0.4 * std::sin(0.11 * t); },
                         [](const std::vector<double>&, const std::vector<double>& F) {
                           std::vector<double> U;
                           for (const double f : F) U.push_back(0.1 + 0.5 * f);
                           return U;
                         },
                         0.002);
  for (Channel& one : c.records.front().trace.channels)
    for (std::size_t i = 0; one.name == channel && i < one.value.size(); i += every) one.value[i] = kMissingSample;
  return c;
}

TEST(SampleNoise, ARecordingThatMissesEveryThirdSampleHasTheFloorOfAWholeOne) {
  const Diagnosis whole = answer(missing("none", 3));
  for (const char* channel : {"U", "F_ref"}) {
    const Diagnosis d = answer(missing(channel, 3));
    EXPECT_NEAR(d.floor, whole.floor, 0.1 * whole.floor) << channel;
    EXPECT_NEAR(d.voltage_range_V, whole.voltage_range_V, 0.05 * whole.voltage_range_V) << channel;
  }
}

// Means of samples that were rounded, over the places that a value may have between two steps.
TEST(SampleNoise, WhatADitheredStepLeavesInAMean) {
  constexpr double kStep = 0.025;
  constexpr int kPlaces = 100, kSamples = 20000;
  for (const double noise : {0.0, 0.1 * kStep, 0.24 * kStep, 0.35 * kStep}) {
    Rng rng(5, "dither");
    double square = 0.0;
    for (int i = 0; i < kPlaces; ++i) {
      const double x = (i + 0.5) / kPlaces * kStep;
      double mean = 0.0;
      for (int k = 0; k < kSamples; ++k) mean += std::round((x + noise * rng.normal()) / kStep) * kStep / kSamples;
      square += (mean - x) * (mean - x) / kPlaces;
    }
    EXPECT_NEAR(left_of_dithered_step(kStep, noise), std::sqrt(square), 0.03 * kStep / std::sqrt(12.0)) << noise;
  }
  EXPECT_NEAR(left_of_dithered_step(1.0, 0.0), 1.0 / std::sqrt(12.0), 0.01);
  EXPECT_LT(left_of_dithered_step(1.0, 0.6), 1e-3);
  EXPECT_EQ(left_of_dithered_step(0.0, 1.0), 0.0);
}

}  // namespace
}  // namespace forcegate::diagnose
