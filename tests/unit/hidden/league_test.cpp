#include "hil/app/league/league.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <set>

#include "hil/app/diagnose/diagnose.h"
#include "hil/app/league/league_stage.h"
#include "hil/app/league/league_tally.h"
#include "hil/app/model/model_input.h"
#include "rigs/emulated/hidden/campaign_writer.h"

namespace forcegate {
namespace {

/// Answers from the data alone, differently for different campaigns: enough to see mixed-up results.
LeagueEngine fake_engine() {
  return {"fake", [](hidden::MadeCampaign&& made) -> Result<LeagueReply> {
            const bool even = made.records.size() % 2 == 0;
            if (made.records.size() == 9) return fail(ErrorCode::internal, "nine records are too many");
            if (even) return LeagueReply{R"({"verdict":"none"})", "none"};
            return LeagueReply{
                R"({"verdict":"known","findings":[{"effect":"hum","side":"instrument","probability":0.8}]})",
                "hum"};
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

TEST(League, TheNextCommandMakesTheGravestMissAgain) {
  LeagueRequest request;
  request.seed = 4;
  request.only = {"hum"};
  request.per_effect = 1;
  const LeagueEngine silent{"silent", [](hidden::MadeCampaign&&) -> Result<LeagueReply> { return LeagueReply{R"({"verdict":"none"})", "none"}; }};
  const auto result = play_league(request, silent, nullptr);
  ASSERT_TRUE(result);
  const auto strong = std::ranges::find(result->matches, hidden::Tier::strong, &LeagueMatch::tier);
  ASSERT_NE(strong, result->matches.end());
  EXPECT_EQ(league_next(*result), "forcegate mystery missed --seed " + std::to_string(strong->seed) + " --minutes 5 --effect hum --strength strong");

  LeagueRequest clean = request;
  clean.only = {"none"};
  clean.controls = 2;
  const auto right = play_league(clean, silent, nullptr);
  ASSERT_TRUE(right);
  EXPECT_EQ(league_next(*right), "forcegate league --seed 5");
  const LeagueEngine loud{"loud", [](hidden::MadeCampaign&&) -> Result<LeagueReply> {
                            return LeagueReply{R"({"verdict":"known","findings":[{"effect":"hum","side":"instrument","probability":0.8}]})", "hum"};
                          }};
  const auto wrong = play_league(clean, loud, nullptr);
  ASSERT_TRUE(wrong);
  EXPECT_TRUE(league_next(*wrong).ends_with(" --minutes 5 --effect none")) << league_next(*wrong);
}

TEST(League, AnEngineThatGivesNoAnswerMisses) {
  LeagueRequest request;
  request.seed = 4;
  request.only = {"hum"};
  const LeagueEngine broken{"broken", [](hidden::MadeCampaign&&) -> Result<LeagueReply> {
                              return fail(ErrorCode::internal, "no");
                            }};
  const auto none = play_league(request, broken, nullptr);
  ASSERT_FALSE(none) << "a table of no answers looks like one of misses";
  EXPECT_NE(none.error().text.find("the engine answered none of 3 campaigns: no"), std::string::npos) << none.error().text;
  std::atomic<int> asked = 0;
  const LeagueEngine failing{"failing", [&](hidden::MadeCampaign&&) -> Result<LeagueReply> {
                               if (asked++ > 0) return fail(ErrorCode::internal, "no");
                               return LeagueReply{R"({"verdict":"none"})", "none"};
                             }};
  const auto result = play_league(request, failing, nullptr);
  ASSERT_TRUE(result) << result.error().to_text();
  const LeagueTally t = tally(*result);
  EXPECT_EQ(t.no_answer.k + 1, t.no_answer.n);
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
  EXPECT_EQ(t.by_effect.at("creep").instead.at("lag"), 1);
  EXPECT_EQ(t.calibration_error, 0.0) << "four findings are too few to judge a calibration";
}

TEST(League, AnInterruptedLeagueGoesOnFromItsJournal) {
  const std::filesystem::path journal =
      std::filesystem::path(::testing::TempDir()) / "forcegate_league_journal.jsonl";
  std::filesystem::remove(journal);
  LeagueRequest request;
  request.seed = 4;
  request.only = {"hum", "outliers"};
  request.threads = 1;
  request.journal = journal;
  int played = 0;
  LeagueEngine engine = fake_engine();
  engine.answer = [&played, answer = engine.answer](hidden::MadeCampaign&& made) {
    ++played;
    return answer(std::move(made));
  };
  const auto text_of = [&] {
    auto result = play_league(request, engine, nullptr);
    EXPECT_TRUE(result) << (result ? "" : result.error().to_text());
    result->seconds = 0.0;
    return league_text(*result) + league_json(*result);
  };
  const std::string whole = text_of();
  EXPECT_EQ(played, 6);
  EXPECT_EQ(text_of(), whole);
  EXPECT_EQ(played, 6) << "nothing is played twice";

  // cut within the last line, as a power failure leaves it
  std::filesystem::resize_file(journal, std::filesystem::file_size(journal) - 20);
  request.only = {"hum"};
  text_of();
  EXPECT_EQ(played, 6);
  request.only = {"hum", "outliers"};
  text_of();
  EXPECT_EQ(played, 7);

  request.seed = 5;
  const auto other = play_league(request, engine, nullptr);
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().text.find("another job"), std::string::npos) << other.error().to_text();
  std::filesystem::remove(journal);
}

TEST(BuiltInEngine, MeasuresItsStartingModelOnTheTwinAsAComparisonDoes) {
  const hidden::CampaignRequest request{62, "campaign", {"hysteresis"}, hidden::Tier::strong, 2.0};
  auto twin = hidden::make_twin(request), same = hidden::make_twin(request);
  ASSERT_TRUE(twin && same);
  diagnose::EngineOptions options = engine_options(*library_model("flexiforce"), 1);
  options.search = false;
  const auto workspace = diagnose::prepare(hidden::to_campaign(std::move(*same)), options);
  ASSERT_TRUE(workspace) << workspace.error().to_text();
  const LeagueEngine engine = built_in_engine();
  const auto base = engine.base(std::move(*twin), false);
  ASSERT_TRUE(base) << base.error().to_text();
  const auto compared = diagnose::compare_workspace(**workspace, options);
  ASSERT_TRUE(compared) << compared.error().to_text();
  EXPECT_NEAR(base->output.own_levels, compared->error_before, 1e-12);
  EXPECT_GE(base->output.common_levels, base->output.own_levels);

  auto made = hidden::make_campaign(request);
  ASSERT_TRUE(made);
  const auto reply = engine.answer(std::move(*made));
  ASSERT_TRUE(reply && reply->base);
  const double before = *answer_from_json(reply->json)->error_before;
  EXPECT_NEAR(reply->base->output.own_levels, before, 0.05 * before);
  EXPECT_LT(base->output.own_levels, 0.9 * before) << "a strong effect adds to the error";
}

// A late reference that shows only beside the loop is set aside in the diagnosis alone, and a note says so.
TEST(BuiltInEngine, TheStartingModelOfADiagnosisMayBeJudgedWithoutTheLatenessOfTheReference) {
  auto made = hidden::make_campaign({61, "campaign", {"hysteresis"}, hidden::Tier::strong, 2.0});
  ASSERT_TRUE(made);
  const auto reply = built_in_engine().answer(std::move(*made));
  ASSERT_TRUE(reply && reply->base);
  EXPECT_NE(reply->json.find("leads the reference by a few milliseconds"), std::string::npos);
  const double before = *answer_from_json(reply->json)->error_before;
  EXPECT_NEAR(reply->base->output.own_levels, before, 0.15 * before);
}

TEST(League, TheReducibleErrorIsToldByAnEngineThatTellsItsStartingModelAloneAndKeptInTheJournal) {
  const std::filesystem::path journal =
      std::filesystem::path(::testing::TempDir()) / "forcegate_league_twin.jsonl";
  std::filesystem::remove(journal);
  LeagueRequest request;
  request.seed = 4;
  request.only = {"hysteresis", "outliers", "none"};
  request.controls = 1;
  request.threads = 1;
  request.journal = journal;
  int twins = 0;
  LeagueEngine engine{
      "fake",
      [](hidden::MadeCampaign&&) -> Result<LeagueReply> {
        return LeagueReply{
            R"({"verdict":"known","findings":[{"effect":"hysteresis"}],"error_before":0.04,"error_after":0.025})",
            "", diagnose::BaseErrors{{0.04, 0.04}, std::nullopt}};
      },
      [&twins](hidden::MadeCampaign&& twin, bool) -> Result<diagnose::BaseErrors> {
        ++twins;
        EXPECT_TRUE(twin.truth.effects.empty());
        return diagnose::BaseErrors{{0.02, 0.02}, std::nullopt};
      }};
  const auto play = [&] {
    auto result = play_league(request, engine, nullptr);
    EXPECT_TRUE(result) << (result ? "" : result.error().to_text());
    result->seconds = 0.0;
    return *result;
  };
  const LeagueResult first = play();
  EXPECT_EQ(twins, 3) << "not of clean campaigns, nor of what no model predicts";
  for (const TierTally& tier : tally(first).tiers) {
    ASSERT_EQ(tier.removed.size(), 1u);
    EXPECT_DOUBLE_EQ(tier.removed.front(), 0.75);
    EXPECT_EQ(tier.removed_named, tier.removed);
  }
  EXPECT_NE(league_text(first).find("reducible error removed"), std::string::npos);
  const LeagueResult again = play();
  EXPECT_EQ(twins, 3) << "nothing is asked twice";
  EXPECT_EQ(league_text(again) + league_json(again), league_text(first) + league_json(first));
  std::filesystem::remove(journal);

  request.journal.clear();
  engine.base = {};
  EXPECT_EQ(league_text(play()).find("reducible error removed"), std::string::npos);
}

LeagueMatch single(const std::string& hidden_effect, const std::string& json, bool excited = true) {
  LeagueMatch match;
  match.kind = LeagueClass::single;
  match.tier = hidden::Tier::medium;
  match.effects = {hidden_effect};
  hidden::TruthEffect effect;
  effect.name = hidden_effect;
  effect.side = "sensor";
  effect.excited = excited;
  match.truth.effects = {effect};
  match.answer = *answer_from_json(json);
  match.score = score(match.truth, match.answer);
  return match;
}

TEST(Miss, SaysAtWhichStepItWasLost) {
  const auto stage = [](const LeagueMatch& m) { return miss_of(m).stage; };
  EXPECT_EQ(
      stage(single("creep", R"({"verdict":"known","findings":[{"effect":"creep","probability":0.9}]})")),
      MissStage::none);
  EXPECT_EQ(stage(single("creep", R"({"verdict":"none"})", false)), MissStage::not_excited);
  EXPECT_EQ(stage(single("hum", R"({"verdict":"none"})")), MissStage::raw_health);
  EXPECT_EQ(stage(single("thermal", R"({"verdict":"none","ranking":[{"effect":"lag","score":3}]})")),
            MissStage::not_a_candidate);
  EXPECT_EQ(stage(single("creep", R"({"verdict":"none","ranking":[{"effect":"creep","score":9}]})")),
            MissStage::evidence);
  const LeagueMatch behind = single("creep",
                                    R"({"verdict":"known","findings":[{"effect":"lag","probability":0.9}],
          "ranking":[{"effect":"creep","score":50},{"effect":"lag","score":90}]})");
  EXPECT_EQ(stage(behind), MissStage::outranked);
  EXPECT_EQ(miss_of(behind).other, "lag");
  const LeagueMatch refused = single(
      "creep",
      R"({"verdict":"unknown","ranking":[{"effect":"creep","score":50}],"refused":[{"effect":"creep","reason":"why not"}]})");
  EXPECT_EQ(stage(refused), MissStage::refused);
  EXPECT_EQ(miss_of(refused).detail, "why not");
  EXPECT_EQ(stage(single("creep", R"({"verdict":"known","findings":[{"effect":"lag","probability":0.6},
                                                                     {"effect":"creep","probability":0.3}]})")),
            MissStage::outclaimed);
}

TEST(Miss, OfACleanCampaignTellsAClaimFromAnUnknown) {
  LeagueMatch clean;
  clean.answer = *answer_from_json(R"({"verdict":"known","findings":[{"effect":"lag","probability":0.6}]})");
  clean.score = score(clean.truth, clean.answer);
  EXPECT_EQ(miss_of(clean).stage, MissStage::false_claim);
  EXPECT_EQ(miss_of(clean).other, "lag");
  clean.answer = *answer_from_json(R"({"verdict":"unknown"})");
  clean.score = score(clean.truth, clean.answer);
  EXPECT_EQ(miss_of(clean).stage, MissStage::called_unknown);
}

TEST(BuiltInEngine, AnswersWithoutFilesAsItDoesWithThem) {
  const hidden::CampaignRequest request{64, "campaign", {"hysteresis"}, hidden::Tier::strong, 2.0};
  const auto folder = std::filesystem::path(::testing::TempDir()) / "forcegate_league_engine";
  std::filesystem::remove_all(folder);
  auto made = hidden::make_campaign(request);
  ASSERT_TRUE(made);
  ASSERT_TRUE(hidden::write_campaign(*made, folder, true));
  auto reply = built_in_engine().answer(std::move(*made));
  ASSERT_TRUE(reply) << reply.error().to_text();
  const auto from_files = diagnose_request({folder, "", {}, 0.0, 1});
  ASSERT_TRUE(from_files) << from_files.error().to_text();
  const Answer a = *answer_from_json(reply->json), b = *answer_from_json(to_json(*from_files));
  EXPECT_EQ(a.verdict, b.verdict);
  ASSERT_EQ(a.findings.size(), b.findings.size());
  for (std::size_t i = 0; i < a.findings.size(); ++i) {
    EXPECT_EQ(a.findings[i].effect, b.findings[i].effect);
    EXPECT_NEAR(a.findings[i].probability, b.findings[i].probability, 0.02) << "the files hold fewer digits";
  }
  EXPECT_FALSE(reply->naive.empty());
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace forcegate
