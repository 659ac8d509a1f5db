#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "rigs/emulated/hidden/campaign_maker.h"
#include "tests/support/campaign_effects.h"

namespace forcegate::hidden {
namespace {

std::vector<std::string> all_names() {
  std::vector<std::string> names = effect_names(false);
  for (std::string& name : effect_names(true)) names.push_back(std::move(name));
  return names;
}

MadeCampaign make_at(const std::string& name, double strength, std::uint64_t seed) {
  auto made = make_campaign_at({seed, "t", {name}, Tier::medium, 1.0}, {strength});
  EXPECT_TRUE(made) << (made ? "" : made.error().to_text());
  return std::move(*made);
}

class EveryEffect : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryEffect, AtStrengthZeroChangesNoSampleAtAll) {
  const MadeCampaign made = make_at(GetParam(), 0.0, 3);
  EXPECT_EQ(made.truth.effects[0].rms_voltage_pct, 0.0);
  EXPECT_EQ(made.truth.effects[0].rms_force_pct, 0.0);
  EXPECT_FALSE(made.truth.effects[0].excited);
}

TEST_P(EveryEffect, IsExcitedByItsOwnCampaignAndItsSizeIsWhatTheSamplesSay) {
  const auto made = make_campaign({5, "t", {GetParam()}, Tier::strong, 2.0});
  ASSERT_TRUE(made) << made.error().to_text();
  const TruthEffect& effect = made->truth.effects[0];
  EXPECT_TRUE(effect.excited);
  EXPECT_FALSE(effect.form.empty());

  const auto without = make_campaign_at({5, "t", {GetParam()}, Tier::strong, 2.0}, {0.0});
  ASSERT_TRUE(without);
  double voltage = 0.0, force = 0.0, nv = 0.0, nf = 0.0;
  for (std::size_t r = 0; r < made->records.size(); ++r)
    for (std::size_t i = 0; i < made->records[r].stamp_s.size(); ++i) {
      const double dv = made->records[r].voltage_V[i] - without->records[r].voltage_V[i];
      const double df = made->records[r].force_unrounded_N[i] - without->records[r].force_unrounded_N[i];
      if (std::isfinite(dv)) voltage += dv * dv, nv += 1.0;
      if (std::isfinite(df)) force += df * df, nf += 1.0;
    }
  EXPECT_NEAR(100.0 * std::sqrt(voltage / nv) / made->truth.voltage_span_V, effect.rms_voltage_pct, 1e-9);
  EXPECT_NEAR(100.0 * std::sqrt(force / nf) / made->truth.force_span_N, effect.rms_force_pct, 1e-9);
}

std::string test_name(const ::testing::TestParamInfo<std::string>& info) { return info.param; }

INSTANTIATE_TEST_SUITE_P(Hidden, EveryEffect, ::testing::ValuesIn(all_names()), test_name);

TEST(Catalogue, HoldsEveryNameOfTheCampaignFormat) {
  const std::set<std::string>& wanted = test::kCampaignEffects;
  const std::vector<std::string> known = effect_names(false);
  EXPECT_EQ(std::set<std::string>(known.begin(), known.end()), wanted);
  for (const std::string& foreign : effect_names(true)) EXPECT_EQ(wanted.count(foreign), 0u) << foreign;
  EXPECT_GE(effect_names(true).size(), 6u);
}

TEST(Catalogue, EverySideIsOneOfTheFour) {
  const std::set<std::string> sides = {"sensor", "rig", "reference", "instrument"};
  for (const HiddenKind& kind : Registry<HiddenKind>::instance().all())
    EXPECT_EQ(sides.count(kind.side), 1u) << kind.name;
}

/// Runs the film hook of an effect on a path of forces.
std::vector<double> film_response(const std::string& name, double strength, std::uint64_t seed,
                                  std::vector<double> path_N, double step_s) {
  const HiddenKind* kind = Registry<HiddenKind>::instance().find(name);
  Rng rng(seed);
  const auto effect = kind->make(rng);
  effect->set_strength(strength);
  const RecordPlan plan;
  const RecordTruth truth;
  const Climate climate;
  const RecordContext context{plan, truth, climate};
  effect->begin_campaign();
  effect->begin_record(context);
  Waves waves;
  waves.step_s = step_s;
  waves.setpoint_N = waves.force_N = waves.film_N = std::move(path_N);
  effect->film(waves, context);
  return waves.film_N;
}

std::vector<double> triangle(std::size_t points, double low_N, double high_N) {
  std::vector<double> path;
  for (std::size_t i = 0; i < points; ++i)
    path.push_back(low_N + (high_N - low_N) * static_cast<double>(i) / static_cast<double>(points));
  for (std::size_t i = 0; i < points; ++i)
    path.push_back(high_N - (high_N - low_N) * static_cast<double>(i) / static_cast<double>(points));
  return path;
}

TEST(Hysteresis, DoesNotDependOnTheSpeedOfLoading) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto fast = film_response("hysteresis", 1.0, seed, triangle(1000, 0.2, 4.0), 0.001);
    const auto slow = film_response("hysteresis", 1.0, seed, triangle(10000, 0.2, 4.0), 0.001);
    for (std::size_t i = 0; i < fast.size(); i += 50)
      EXPECT_NEAR(fast[i], slow[10 * i], 2e-3) << "seed " << seed;
  }
}

TEST(Hysteresis, OpensALoopThatClosesAtTheTurningPoints) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    std::vector<double> path = triangle(2000, 0.0, 4.0);
    const auto first = triangle(2000, 0.0, 4.0);
    path.insert(path.end(), first.begin(), first.end());
    const auto out = film_response("hysteresis", 1.0, seed, path, 0.001);
    EXPECT_GT(std::abs(out[7000] - out[5000]), 0.005) << "up and down at 2 N differ, seed " << seed;
    EXPECT_NEAR(out[2000], out[6000], 0.01) << "two visits of the top, seed " << seed;
  }
}

TEST(Creep, GrowsUnderConstantLoadEverMoreSlowlyAndReturns) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    std::vector<double> path(60000, 3.0);
    path.insert(path.end(), 60000, 0.0);
    const auto out = film_response("creep", 1.0, seed, path, 0.01);
    const double first = out[6000] - out[600], later = out[60000 - 1] - out[54600 - 1];
    EXPECT_GT(first, 0.0);
    EXPECT_GT(later, 0.0);
    EXPECT_GT(first, later);
    EXPECT_GT(out[60100], out[119999]) << "what is left after unloading fades";
  }
}

TEST(Lag, DelaysAStepWithoutChangingWhereItEnds) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    std::vector<double> path(100, 0.0);
    path.insert(path.end(), 2000, 2.0);
    const auto out = film_response("lag", 1.0, seed, path, 0.001);
    EXPECT_LT(out[105], 1.8);
    EXPECT_NEAR(out.back(), 2.0, 1e-6);
    EXPECT_TRUE(std::is_sorted(out.begin() + 100, out.end()));
  }
}

TEST(DeadZone, TakesTheForceThatClosesTheContacts) {
  const auto out = film_response("dead_zone", 1.0, 4, {0.0, 0.01, 1.0, 2.0, 4.0}, 0.001);
  EXPECT_EQ(out[0], 0.0);
  EXPECT_LT(out[1], 0.005);
  EXPECT_NEAR(out[4] - out[3], 2.0, 0.03) << "straight above the threshold";
  EXPECT_LT(out[4], 4.0);
}

}  // namespace
}  // namespace forcegate::hidden
