#include "rigs/emulated/hidden/detectability.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rigs/emulated/hidden/campaign_maker.h"

namespace forcegate::hidden {
namespace {

constexpr double kScatter = 0.01;

Conditions repeatable_to_a_percent() {
  Conditions c;
  c.sd_gain = kScatter;
  c.sd_offset_pct = 0.1;
  c.voltage_noise_V = 1e-6;
  c.wander_V = 0.0;
  return c;
}

/// Triangles of 1 to 5 V, one per record, in sessions of `per_session` records.
std::vector<RecordData> triangles(std::size_t count, std::size_t per_session = 1) {
  std::vector<RecordData> records(count);
  for (std::size_t r = 0; r < count; ++r) {
    records[r].plan.session_seed = r / per_session;
    for (int i = 0; i <= 400; ++i) records[r].voltage_V.push_back(5.0 - 0.02 * std::abs(i - 200));
  }
  return records;
}

std::vector<RecordData> scaled(std::vector<RecordData> records, const std::vector<double>& gain) {
  for (std::size_t r = 0; r < records.size(); ++r)
    for (double& v : records[r].voltage_V) v *= 1.0 + gain[r];
  return records;
}

double of_gains(const std::vector<double>& gain, const Conditions& c, std::size_t per_session = 1) {
  const auto without = triangles(gain.size(), per_session);
  return detectability_between(scaled(without, gain), without, c, Measure::voltage);
}

TEST(Detectability, IsTheEffectAboutItsMeanOverTheScatter) {
  const std::vector<double> gain = {0.02, -0.02, 0.02, -0.02};
  EXPECT_NEAR(of_gains(gain, repeatable_to_a_percent()), 0.04 / kScatter, 0.01);
}

TEST(Detectability, WhatAllRecordsShareIsNoSign) { EXPECT_NEAR(of_gains({0.05, 0.05, 0.05, 0.05}, repeatable_to_a_percent()), 0.0, 0.01); }

TEST(Detectability, AChangeBetweenSessionsThatScatterTogetherShowsLess) {
  Conditions c = repeatable_to_a_percent();
  const std::vector<double> gain = {0.02, 0.02, 0.02, -0.02, -0.02, -0.02};
  const double alone = of_gains(gain, c, 3);
  c.session_share = 0.8;
  // variance of the mean of three: s^2 (0.2 / 3 + 0.8) instead of s^2 / 3
  EXPECT_NEAR(of_gains(gain, c, 3), alone * std::sqrt((1.0 / 3.0) / (0.2 / 3.0 + 0.8)), 0.01);
}

TEST(Detectability, AChangeWithinSessionsThatScatterTogetherShowsMore) {
  Conditions c = repeatable_to_a_percent();
  const std::vector<double> gain = {0.02, -0.02, 0.02, -0.02};
  const double alone = of_gains(gain, c, 4);
  c.session_share = 0.75;
  EXPECT_NEAR(of_gains(gain, c, 4), 2.0 * alone, 0.02);
}

TEST(Detectability, TheSheetTellsItOfEffectsBetweenRecordsAndGrowsWithTheStrength) {
  const auto sheet = [](const char* effect, Tier tier) {
    auto made = make_campaign({5, "t", {effect}, tier, 1.0});
    return made->truth.effects.at(0);
  };
  const TruthEffect weak = sheet("thermal", Tier::weak), strong = sheet("thermal", Tier::strong), within = sheet("creep", Tier::strong);
  EXPECT_TRUE(weak.between_records);
  EXPECT_GT(strong.detectability, 2.0 * weak.detectability);
  EXPECT_FALSE(within.between_records);
  EXPECT_EQ(within.detectability, 0.0);
}

TEST(Detectability, ACauseIsRecordedWhereTheColumnsHoldIt) {
  int with_column = 0, without_column = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const auto made = make_campaign({seed, "t", {"humidity"}, Tier::strong, 1.0});
    const bool column = !made->records.front().humidity_pct.empty();
    EXPECT_EQ(made->truth.effects.at(0).cause_recorded, column);
    ++(column ? with_column : without_column);
  }
  EXPECT_GT(with_column, 0);
  EXPECT_GT(without_column, 0);
}

}  // namespace
}  // namespace forcegate::hidden
