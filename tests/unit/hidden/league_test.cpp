#include "hil/app/league.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "hil/app/league_tally.h"

namespace forcegate {
namespace {

/// Answers from the data alone, differently for different campaigns: enough to see mixed-up results.
LeagueEngine fake_engine() {
  return {
      "fake", [](hidden::MadeCampaign&& made) -> Result<std::string> {
        const bool even = made.records.size() % 2 == 0;
        if (made.records.size() == 9) return fail(ErrorCode::internal, "nine records are too many");
        return even
                   ? std::string(R"({"verdict":"none"})")
                   : R"({"verdict":"known","findings":[{"effect":"hum","side":"instrument","probability":0.8}]})";
      }};
}

TEST(LeagueProgramme, TheFullOneHasAHundredControlsAndFiveOfEachEffectAndStrength) {
  LeagueRequest request;
  request.full = true;
  const auto programme = league_programme(request);
  const auto count = [&](LeagueClass kind) {
    return std::count_if(programme.begin(), programme.end(),
                         [&](const LeagueMatch& m) { return m.kind == kind; });
  };
  EXPECT_GE(count(LeagueClass::control), 100);
  EXPECT_EQ(count(LeagueClass::single), static_cast<long>(hidden::effect_names(false).size() * 15));
  EXPECT_GE(count(LeagueClass::pair), 40);
  EXPECT_GE(count(LeagueClass::foreign), 40);
}

TEST(LeagueProgramme, NoTwoCampaignsShareASeedWithinOrBetweenLeagues) {
  std::set<std::uint64_t> seeds;
  std::size_t n = 0;
  for (const std::uint64_t seed : {1u, 2u}) {
    LeagueRequest request;
    request.seed = seed;
    for (const LeagueMatch& match : league_programme(request)) seeds.insert(match.seed), ++n;
  }
  EXPECT_EQ(seeds.size(), n);
}

TEST(League, TheTableDoesNotDependOnTheNumberOfThreads) {
  LeagueRequest request;
  request.seed = 4;
  request.only = {"none", "hum"};
  const auto text_of = [&](unsigned threads) {
    request.threads = threads;
    auto result = play_league(request, fake_engine(), nullptr);
    EXPECT_TRUE(result);
    for (LeagueMatch& match : result->matches) match.engine_s = match.generation_s = 0.0;
    result->seconds = 0.0;
    result->request.threads = 0;
    return league_text(*result) + league_json(*result);
  };
  EXPECT_EQ(text_of(1), text_of(3));
}

TEST(League, AnEngineThatGivesNoAnswerMisses) {
  LeagueRequest request;
  request.seed = 4;
  request.only = {"hum"};
  const LeagueEngine broken{"broken", [](hidden::MadeCampaign&&) -> Result<std::string> {
                              return fail(ErrorCode::internal, "no");
                            }};
  const auto result = play_league(request, broken, nullptr);
  ASSERT_TRUE(result);
  const LeagueTally t = tally(*result);
  EXPECT_EQ(t.no_answer.k, t.no_answer.n);
  EXPECT_EQ(t.tiers[0].named.k + t.tiers[1].named.k + t.tiers[2].named.k, 0u);
  EXPECT_TRUE(std::all_of(result->matches.begin(), result->matches.end(), is_miss));
}

TEST(League, NothingToPlayIsAUsageError) {
  LeagueRequest request;
  request.only = {"no_such_effect"};
  EXPECT_FALSE(play_league(request, fake_engine(), nullptr));
}

TEST(Tally, CountsCalibrationByWhatWasStated) {
  LeagueResult result;
  for (int k = 0; k < 4; ++k) {
    LeagueMatch match;
    match.kind = LeagueClass::single;
    match.tier = hidden::Tier::weak;
    match.effects = {"creep"};
    hidden::TruthEffect effect;
    effect.name = "creep";
    effect.side = "sensor";
    match.truth.effects = {effect};
    match.answer.verdict = "known";
    match.answer.findings = {{k < 3 ? "creep" : "lag", "sensor", 0.85, {}}};
    match.score = score(match.truth, match.answer);
    result.matches.push_back(match);
  }
  const LeagueTally t = tally(result);
  EXPECT_EQ(t.tiers[0].named.k, 3u);
  EXPECT_EQ(t.tiers[0].named.n, 4u);
  for (const CalibrationBin& bin : t.calibration) {
    if (bin.truth.n == 0) continue;
    EXPECT_EQ(bin.truth.n, 4u);
    EXPECT_EQ(bin.truth.k, 3u);
    EXPECT_NEAR(bin.stated, 3.4, 1e-12);
  }
  EXPECT_EQ(t.confusions.at("creep").at("lag"), 1);
}

}  // namespace
}  // namespace forcegate
