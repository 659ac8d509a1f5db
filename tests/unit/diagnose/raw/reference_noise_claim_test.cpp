#include "hil/diagnose/raw/reference_noise_claim.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace forcegate::diagnose {
namespace {

RecordHealth record(double noise_N, double noise_V = 0.002) {
  RecordHealth h;
  h.noise_F_N = noise_N;
  h.scatter_F.quartile_N = h.scatter_F.alone_N = h.scatter_F.still_N = noise_N;
  h.noise_U_V = noise_V;
  return h;
}

constexpr double kQuiet_N = 0.004, kLoud_N = 0.03;

std::vector<RecordHealth> late_part() {
  return {record(kQuiet_N), record(1.1 * kQuiet_N), record(0.9 * kQuiet_N), record(kLoud_N), record(1.2 * kLoud_N), record(kLoud_N)};
}

HealthScales scales() {
  HealthScales out;
  out.range_N = 5.0;
  return out;
}

TEST(ReferenceNoiseClaim, WhatIsQuietInSomeRecordsAndRestlessInOthersNeedsNoDeclaration) {
  const auto claim = claim_of_reference_noise(late_part(), scales(), {});
  ASSERT_TRUE(claim.has_value());
  EXPECT_EQ(claim->effect, "reference_noise");
  EXPECT_GE(claim->probability, 0.5);
  EXPECT_NEAR(claim->value, kLoud_N, 0.1 * kLoud_N);
  EXPECT_THAT(claim->evidence, ::testing::HasSubstr("in 3 of 6 records"));
}

TEST(ReferenceNoiseClaim, OneRestlessRecordIsNoClaim) {
  std::vector<RecordHealth> health = late_part();
  health.resize(4);
  EXPECT_FALSE(claim_of_reference_noise(health, scales(), {}).has_value());
}

// Of a force that moves in every window the scatter is not known, which is no scatter of 0.
TEST(ReferenceNoiseClaim, RecordsThatMoveThroughoutHideNoneOfTheOthers) {
  BenchFacts bench;
  bench.reference_noise_N = 0.01;
  std::vector<RecordHealth> health;
  for (int k = 0; k < 4; ++k) health.push_back(record(kLoud_N));
  for (int k = 0; k < 3; ++k) {
    health.push_back(record(kLoud_N));
    health.back().scatter_F.quartile_N = health.back().scatter_F.alone_N = 0.0;
  }
  for (RecordHealth& h : health) h.scatter_F.still_N = 0.0;
  EXPECT_TRUE(claim_of_reference_noise(health, scales(), bench).has_value());
  for (int k = 0; k < 2; ++k) health.push_back(health.back());
  EXPECT_FALSE(claim_of_reference_noise(health, scales(), bench).has_value()) << "fewer than half tell";
}

TEST(ReferenceNoiseClaim, WhatTheOutputSharesIsNotTheReferences) {
  std::vector<RecordHealth> health = late_part();
  for (std::size_t k = 3; k < health.size(); ++k) health[k].noise_U_V *= 5.0;
  EXPECT_FALSE(claim_of_reference_noise(health, scales(), {}).has_value());
}

TEST(ReferenceNoiseClaim, AForceThatIsFastWhileTheOutputMovesIsNoNoise) {
  std::vector<RecordHealth> health = late_part();
  for (std::size_t k = 3; k < health.size(); ++k) health[k].scatter_F.still_N = 0.0;
  EXPECT_FALSE(claim_of_reference_noise(health, scales(), {}).has_value());
}

// Of a noisy output a difference is taken off, which may leave nothing.
TEST(ReferenceNoiseClaim, WhatANoisyOutputHidesIsNotQuiet) {
  std::vector<RecordHealth> health(5, record(kLoud_N));
  for (std::size_t k = 0; k < 2; ++k) health[k].scatter_F.alone_N = 0.0;
  EXPECT_FALSE(claim_of_reference_noise(health, scales(), {}).has_value());
}

TEST(ReferenceNoiseClaim, MovementLeavesAnotherAmountInEveryRecord) {
  const std::vector<RecordHealth> health = {record(kQuiet_N), record(kQuiet_N), record(4.0 * kQuiet_N), record(8.0 * kQuiet_N), record(20.0 * kQuiet_N)};
  EXPECT_FALSE(claim_of_reference_noise(health, scales(), {}).has_value());
}

// Held, a force that is rounded has no noise at all; where it moves it scatters by a share of its step.
TEST(ReferenceNoiseClaim, RoundingIsNoNoise) {
  constexpr double kStep_N = 0.025;
  std::vector<RecordHealth> health = {record(0.0), record(0.0), record(0.29 * kStep_N), record(0.29 * kStep_N)};
  for (RecordHealth& h : health) h.lsb_F_N = kStep_N;
  EXPECT_FALSE(claim_of_reference_noise(health, scales(), {}).has_value());
}

// A resolution says little of the noise: a converter's step may be far below it.
TEST(ReferenceNoiseClaim, BesideAResolutionAloneItMustBeMoreThanADataSheetPromises) {
  BenchFacts bench;
  bench.reference_resolution_N = 0.002;
  const auto all = [](double noise_N) { return std::vector<RecordHealth>(5, record(noise_N)); };
  EXPECT_FALSE(claim_of_reference_noise(all(0.003 * 5.0), scales(), bench).has_value());
  EXPECT_TRUE(claim_of_reference_noise(all(0.006 * 5.0), scales(), bench).has_value());
  bench.reference_noise_N = 0.002;
  EXPECT_TRUE(claim_of_reference_noise(all(0.003 * 5.0), scales(), bench).has_value()) << "what is declared counts";
}

}  // namespace
}  // namespace forcegate::diagnose
