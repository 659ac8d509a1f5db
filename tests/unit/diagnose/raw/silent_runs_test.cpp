#include "hil/diagnose/raw/silent_runs.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/base/rng.h"

namespace forcegate::diagnose {
namespace {

constexpr double kLsb_V = 0.0025;

// A slow swing about 2 V in codes; below `still_below_V` there is no noise.
std::vector<double> swing(double noise_V, double still_below_V = -1.0) {
  std::vector<double> out;
  Rng rng(5, "codes");
  for (int i = 0; i < 20000; ++i) {
    const double U = 2.0 + std::sin(0.0006 * i) + (i % 4000 < 400 ? 0.3 * std::sin(0.01 * i) : 0.0);
    out.push_back(kLsb_V * std::round((U < still_below_V ? still_below_V : U + noise_V * rng.normal()) / kLsb_V));
  }
  return out;
}

void hold(std::vector<double>& U, std::size_t begin, std::size_t samples) {
  for (std::size_t i = 0; i < samples; ++i) U[begin + i] = U[begin];
}

TEST(SilentRuns, AreLongerThanChanceAllows) {
  std::vector<double> U = swing(3.0 * kLsb_V);
  EXPECT_TRUE(find_silent_runs(U, kLsb_V, 3.0 * kLsb_V).empty());
  hold(U, 5000, 30);
  hold(U, 12000, 3);  // may be by chance
  const std::vector<SilentRun> found = find_silent_runs(U, kLsb_V, 3.0 * kLsb_V);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].begin, 5000u);
  EXPECT_GE(found[0].end, 5030u);
}

TEST(SilentRuns, ShortOnesCountWhereEachStandsAtACodeOfItsOwn) {
  constexpr double kNoise_V = 20.0 * kLsb_V;
  std::vector<double> U = swing(kNoise_V);
  EXPECT_TRUE(find_silent_runs(U, kLsb_V, kNoise_V).empty());
  for (std::size_t k = 0; k < 4; ++k) hold(U, 3000 + 4100 * k, 6);
  EXPECT_EQ(find_silent_runs(U, kLsb_V, kNoise_V).size(), 4U);
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t i = 0; i < 6; ++i) U[3000 + 4100 * k + i] = 2.0;  // a code that is too wide
  EXPECT_TRUE(find_silent_runs(U, kLsb_V, kNoise_V).empty());
}

TEST(SilentRuns, AreNotAskedWhereNoiseStaysWithinACode) {
  std::vector<double> U = swing(0.3 * kLsb_V);
  hold(U, 5000, 60);
  EXPECT_TRUE(find_silent_runs(U, kLsb_V, 0.3 * kLsb_V).empty());
  EXPECT_TRUE(find_silent_runs(U, 0.0, 0.01).empty()) << "no step is visible";
}

TEST(SilentRuns, OfAnOutputThatIsStillWheneverItComesByAreNone) {
  // still at a level that is not the lowest of the record
  std::vector<double> U = swing(3.0 * kLsb_V, 1.5);
  U[77] = 0.5;
  EXPECT_TRUE(find_silent_runs(U, kLsb_V, 3.0 * kLsb_V).empty());
}

TEST(SilentRuns, AtTheEndsOfWhatWasRecordedAreARailOrAFloor) {
  std::vector<double> U = swing(3.0 * kLsb_V);
  double highest = 0.0;
  for (const double u : U) highest = std::max(highest, u);
  for (std::size_t i = 8000; i < 8040; ++i) U[i] = highest;
  EXPECT_TRUE(find_silent_runs(U, kLsb_V, 3.0 * kLsb_V).empty());
}

}  // namespace
}  // namespace forcegate::diagnose
