#include "hil/app/mystery/scoring.h"

#include <gtest/gtest.h>

#include <cmath>

namespace forcegate {
namespace {

hidden::Truth truth_of(std::vector<std::string> names, const std::string& side = "sensor") {
  hidden::Truth truth;
  for (std::string& name : names) {
    hidden::TruthEffect effect;
    effect.name = std::move(name);
    effect.side = side;
    effect.measure = "voltage";
    effect.excited = true;
    effect.heldout_rms = 0.03;
    truth.effects.push_back(std::move(effect));
  }
  return truth;
}

Answer answer(const char* json) {
  auto result = answer_from_json(json);
  EXPECT_TRUE(result) << (result ? "" : result.error().to_text());
  return *result;
}

TEST(Wilson, AgreesWithNewcombe1998) {
  const auto near = [](std::size_t k, std::size_t n, double low, double high) {
    const Interval i = wilson_95(k, n);
    EXPECT_NEAR(i.low, low, 5e-5) << k << "/" << n;
    EXPECT_NEAR(i.high, high, 5e-5) << k << "/" << n;
  };
  near(81, 263, 0.2553, 0.3662);  // Statistics in Medicine 17, 857, table I, method 3
  near(15, 148, 0.0624, 0.1605);
  near(0, 20, 0.0000, 0.1611);
  near(1, 29, 0.0061, 0.1718);
}

TEST(Wilson, IsSymmetricAndKnowsNothingWithoutTrials) {
  EXPECT_NEAR(wilson_95(3, 10).low, 1.0 - wilson_95(7, 10).high, 1e-12);
  EXPECT_EQ(wilson_95(0, 0).low, 0.0);
  EXPECT_EQ(wilson_95(0, 0).high, 1.0);
}

TEST(Quantile, InterpolatesBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(score_quantile({3.0, 1.0, 2.0}, 0.5), 2.0);
  EXPECT_DOUBLE_EQ(score_quantile({1.0, 2.0}, 0.5), 1.5);
  EXPECT_TRUE(std::isnan(score_quantile({}, 0.5)));
}

TEST(Score, TheFirstFindingCountsOnlyUnderTheVerdictKnown) {
  const auto truth = truth_of({"creep"});
  EXPECT_TRUE(
      score(
          truth,
          answer(R"({"verdict":"known","findings":[{"effect":"creep","side":"sensor","probability":0.9}]})"))
          .named);
  EXPECT_FALSE(
      score(truth,
            answer(R"({"verdict":"none","findings":[{"effect":"creep","side":"sensor","probability":0.3}]})"))
          .named);
}

TEST(Score, PlacesAreCountedAndLookAlikesSeen) {
  const Score s = score(truth_of({"lag"}), answer(R"({"verdict":"known","findings":[
      {"effect":"delay","side":"instrument","probability":0.6,"confounded_with":[{"effect":"lag","cos":0.99}]},
      {"effect":"creep","side":"sensor","probability":0.2},{"effect":"lag","side":"sensor","probability":0.4}]})"));
  EXPECT_EQ(s.rank, 3);
  EXPECT_FALSE(s.named);
  EXPECT_FALSE(s.top2);
  EXPECT_TRUE(s.top3);
  EXPECT_TRUE(s.look_alike);
  EXPECT_TRUE(s.side_right);
  EXPECT_EQ(s.false_claims, 1) << "only findings of a half or more are claims";
}

TEST(Score, ACleanCampaignIsMissedByAnyClaimOrVerdict) {
  const hidden::Truth clean;
  EXPECT_TRUE(
      score(clean, answer(R"({"verdict":"none","findings":[{"effect":"creep","probability":0.2}]})")).clean);
  EXPECT_FALSE(score(clean, answer(R"({"verdict":"unknown"})")).clean);
  EXPECT_FALSE(
      score(clean, answer(R"({"verdict":"none","findings":[{"effect":"creep","probability":0.5}]})")).clean);
}

TEST(Score, AForeignEffectWantsUnknownAndNoNames) {
  auto truth = truth_of({"foreign_telegraph"});
  truth.effects[0].foreign = true;
  EXPECT_TRUE(score(truth, answer(R"({"verdict":"unknown","depends_on":["time"]})")).honest);
  EXPECT_FALSE(
      score(truth, answer(R"({"verdict":"unknown","findings":[{"effect":"creep","probability":0.8}]})"))
          .honest);
  EXPECT_FALSE(score(truth, answer(R"({"verdict":"none"})")).honest);
}

TEST(Score, OfAPairBothMustStandInTheFirstThree) {
  const auto truth = truth_of({"creep", "hysteresis"});
  EXPECT_TRUE(
      score(
          truth,
          answer(
              R"({"verdict":"known","findings":[{"effect":"hysteresis"},{"effect":"lag"},{"effect":"creep"}]})"))
          .pair_in_three);
  EXPECT_FALSE(
      score(truth, answer(R"({"verdict":"known","findings":[{"effect":"hysteresis"}]})")).pair_in_three);
}

TEST(Score, BlamingTheSensorForTheRigIsNoticed) {
  const auto truth = truth_of({"backlash"}, "rig");
  EXPECT_TRUE(
      score(
          truth,
          answer(
              R"({"verdict":"known","findings":[{"effect":"hysteresis","side":"sensor","probability":0.9}]})"))
          .sensor_blamed);
  EXPECT_FALSE(
      score(
          truth,
          answer(R"({"verdict":"known","findings":[{"effect":"backlash","side":"rig","probability":0.9}]})"))
          .sensor_blamed);
}

/// Errors at the gain and zero of each record, and at those of all.
TwinErrors output_errors(double campaign_V, double twin_V) {
  return {{{campaign_V, 3.0 * campaign_V}, std::nullopt}, {{twin_V, 3.0 * twin_V}, std::nullopt}};
}

TEST(Reduction, APerfectAnswerRemovesAllAndOneThatChangesNothingNone) {
  const TwinErrors twin = output_errors(0.05, 0.03);
  auto a =
      answer(R"({"verdict":"known","findings":[{"effect":"creep"}],"error_before":0.05,"error_after":0.03})");
  EXPECT_DOUBLE_EQ(score(truth_of({"creep"}), a, &twin).reduction->share(), 1.0);
  a.error_after = 0.05;
  EXPECT_DOUBLE_EQ(score(truth_of({"creep"}), a, &twin).reduction->share(), 0.0);
  a.error_after = 0.04;
  EXPECT_DOUBLE_EQ(score(truth_of({"creep"}), a, &twin).reduction->share(), 0.5);
  a.error_after = 0.2;
  EXPECT_DOUBLE_EQ(score(truth_of({"creep"}), a, &twin).reduction->share(), -1.0) << "clipped";
}

TEST(Reduction, TheSizeOfTheEffectDoesNotMatterOnlyWhatItAddsToTheTwin) {
  auto truth = truth_of({"creep"});
  truth.effects[0].heldout_rms = 0.9;  // far above the error: gain, zero and decay take nearly all of it
  const auto a =
      answer(R"({"verdict":"known","findings":[{"effect":"creep"}],"error_before":0.05,"error_after":0.03})");
  const TwinErrors reducible = output_errors(0.05, 0.03), absorbed = output_errors(0.05, 0.046);
  EXPECT_DOUBLE_EQ(score(truth, a, &reducible).reduction->share(), 1.0);
  EXPECT_FALSE(score(truth, a, &absorbed).reduction);
  EXPECT_FALSE(score(truth, a).reduction) << "without the twin nobody knows";
}

TEST(Reduction, AMissRemovesNothingWhereThereWasSomethingToRemove) {
  const auto miss = answer(R"({"verdict":"none","error_before":0.05,"error_after":0.01})");
  const TwinErrors reducible = output_errors(0.05, 0.03), absorbed = output_errors(0.05, 0.05);
  EXPECT_EQ(score(truth_of({"creep"}), miss, &reducible).reduction->share(), 0.0);
  EXPECT_FALSE(score(truth_of({"creep"}), miss, &absorbed).reduction);
}

TEST(Reduction, WhatActsBetweenRecordsIsMeasuredAtTheGainAndZeroOfAll) {
  const TwinErrors twin{{{0.03, 0.10}, std::nullopt}, {{0.03, 0.04}, std::nullopt}};
  EXPECT_DOUBLE_EQ(score(truth_of({"thermal"}),
                         answer(R"({"verdict":"known","findings":[{"effect":"thermal"}],"adapted":["decay"],
                                    "error_before":0.10,"error_after":0.07})"),
                         &twin)
                       .reduction->share(),
                   0.5);
  EXPECT_EQ(score(truth_of({"thermal"}), answer(R"({"verdict":"none","error_before":0.03,"error_after":0.03})"), &twin)
                .reduction->before,
            0.10)
      << "a miss is a miss of the same";
  EXPECT_FALSE(score(truth_of({"thermal"}),
                     answer(R"({"verdict":"known","findings":[{"effect":"thermal"}],"adapted":["gain","zero","decay"],
                                "error_before":0.03,"error_after":0.03})"),
                     &twin)
                   .reduction)
      << "nothing is added to what each record follows by itself";
}

TEST(Reduction, OfRigAndReferenceIsThatOfTheForce) {
  auto truth = truth_of({"backlash"}, "rig");
  truth.effects[0].measure = "force";
  const TwinErrors twin{{{0.05, 0.05}, diagnose::BaseError{0.20, 0.20}}, {{0.04, 0.04}, diagnose::BaseError{0.10, 0.10}}};
  auto a = answer(R"({"verdict":"known","findings":[{"effect":"backlash","side":"rig"}],"error_before":0.05,
      "error_after":0.05,"errors":{"F":{"before":0.20,"after":0.12,"unit":"N","adapted":["gain","zero","decay"]}}})");
  const Score of_force = score(truth, a, &twin);
  EXPECT_EQ(of_force.reduction->unit, "N");
  EXPECT_DOUBLE_EQ(of_force.reduction->share(), 0.8);
  EXPECT_EQ(score(truth, answer(R"({"verdict":"none"})"), &twin).reduction->unit, "N");
  a.force_error_before.reset();
  EXPECT_FALSE(score(truth, a, &twin).reduction) << "what the rig moves otherwise is no error of the output";
  truth.effects[0].side = "reference";
  EXPECT_EQ(score(truth, a, &twin).reduction->unit, "V");
}

TEST(Reduction, IsNotCountedOfNoisePairsAndForeignEffects) {
  const TwinErrors twin = output_errors(0.05, 0.03);
  const auto a =
      answer(R"({"verdict":"known","findings":[{"effect":"creep"}],"error_before":0.05,"error_after":0.03})");
  auto noise = truth_of({"creep"}), foreign = truth_of({"foreign_telegraph"});
  noise.effects[0].reducible = false;
  foreign.effects[0].foreign = true;
  EXPECT_FALSE(score(noise, a, &twin).reduction);
  EXPECT_FALSE(score(foreign, a, &twin).reduction);
  EXPECT_FALSE(score(truth_of({"creep", "lag"}), a, &twin).reduction);
}

TEST(AnswerFile, FaultsAreNamed) {
  EXPECT_FALSE(answer_from_json("not json"));
  EXPECT_FALSE(answer_from_json(R"({"findings":[]})"));
  EXPECT_FALSE(answer_from_json(R"({"verdict":"perhaps"})"));
}

}  // namespace
}  // namespace forcegate
