#include "hil/diagnose/next/rival_odds.h"

#include "hil/base/slug.h"
#include "hil/diagnose/next/next_experiment.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

Finding finding(const std::string& effect, double probability, const std::string& rival_of = "") {
  Finding f;
  f.effect = effect;
  f.probability = probability;
  f.rival_of = rival_of;
  return f;
}

RankedEffect ranked(const std::string& effect, double score) {
  RankedEffect r;
  r.effect = effect;
  r.score = score;
  return r;
}

TEST(RivalOdds, AreTheRatioOfTheProbabilitiesWhereBothAreStated) {
  Diagnosis d;
  d.findings = {finding("delay", 0.54), finding("lag", 0.45, "delay")};
  d.ranking = {ranked("delay", 1182.0), ranked("lag", 1173.0)};
  const auto odds = rival_odds(d, "lag", "delay");
  ASSERT_TRUE(odds.has_value());
  EXPECT_TRUE(odds->stated);
  EXPECT_NEAR(std::exp(odds->log_odds), 0.45 / 0.54, 1e-12);
}

TEST(RivalOdds, AreThoseOfTheEvidenceWhereTheAnswerStatesNoProbability) {
  Diagnosis d;
  d.findings = {finding("delay", 0.9)};
  d.ranking = {ranked("delay", 12.0), ranked("lag", 9.5), ranked("creep", -300.0)};
  const auto odds = rival_odds(d, "delay", "lag");
  ASSERT_TRUE(odds.has_value());
  EXPECT_FALSE(odds->stated);
  EXPECT_DOUBLE_EQ(odds->log_odds, 2.5);
  EXPECT_DOUBLE_EQ(rival_odds(d, "creep", "delay")->log_odds, -20.0) << "more is not learnt";
}

TEST(RivalOdds, TwoClaimsAreNoRivals) {
  Diagnosis d;
  d.findings = {finding("hysteresis", 0.98), finding("creep", 0.97)};
  EXPECT_FALSE(rival_odds(d, "hysteresis", "creep").has_value());
}

TEST(RivalOdds, OnlyWhatSharesAProbabilityCompetesForOnePlace) {
  Diagnosis d;
  d.findings = {finding("hysteresis", 0.98), finding("delay", 0.4), finding("lag", 0.3, "delay"), finding("rc", 0.25, "delay")};
  EXPECT_TRUE(compete_for_one_place(d, "delay", "lag"));
  EXPECT_TRUE(compete_for_one_place(d, "rc", "delay"));
  EXPECT_TRUE(compete_for_one_place(d, "lag", "rc"));
  EXPECT_FALSE(compete_for_one_place(d, "hysteresis", "lag"));
  EXPECT_FALSE(compete_for_one_place(d, "delay", "creep")) << "creep is no finding";
}

// Late by 20 ms under forces that are slow beside that: a dead time and a lag leave nearly the same.
std::vector<double> late(const std::vector<double>&, const std::vector<double>& F, int) {
  constexpr std::size_t kRows = 4;
  std::vector<double> U;
  for (std::size_t i = 0; i < F.size(); ++i) U.push_back(2.0 * F[i < kRows ? 0 : i - kRows] + 0.2);
  return U;
}

// On slow ramps alone: edges would part the two.
struct LateOutput {
  Result<std::unique_ptr<Workspace>> workspace = [] {
    Campaign c = make_campaign(61, late);
    std::erase_if(c.records, [](const Record& r) { return r.kind != "ramp"; });
    return prepare(std::move(c), options());
  }();
  Result<Diagnosis> answer = workspace ? diagnose_workspace(**workspace, options()) : Result<Diagnosis>(Unexpected(workspace.error()));

  static EngineOptions options() {
    EngineOptions out;
    out.threads = 1;
    return out;
  }
};

TEST(NextExperiment, StartsFromTheOddsThatTheFindingsState) {
  const LateOutput asked;
  ASSERT_TRUE(asked.answer.has_value()) << asked.answer.error().to_text();
  const Diagnosis& d = *asked.answer;
  const NextExperiment next = propose_experiment(**asked.workspace, d);
  ASSERT_FALSE(next.segments.empty()) << told(d);
  const ExperimentSegment& s = next.segments.front();
  const std::string first = s.separates.substr(0, s.separates.find(" / ")), second = s.separates.substr(s.separates.find(" / ") + 3);
  double p = 0.0, q = 0.0;
  for (const Finding& f : d.findings) {
    if (f.effect == first) p = f.probability;
    if (f.effect == second) q = f.probability;
  }
  ASSERT_GT(std::min(p, q), 0.0) << s.separates << "\n" << told(d);
  EXPECT_TRUE(s.odds_stated);
  EXPECT_NEAR(s.odds_before, std::max(p, q) / std::min(p, q), 1e-9) << s.separates << "\n" << told(d);
  EXPECT_GT(s.odds_after, s.odds_before);
}

TEST(NextExperiment, AsksForNoSegmentThatWasPlayedAndLeftThemOpen) {
  const LateOutput asked;
  ASSERT_TRUE(asked.answer.has_value()) << asked.answer.error().to_text();
  const std::string name = propose_experiment(**asked.workspace, *asked.answer).segments.at(0).name;
  RecordInput& record = (*asked.workspace)->input.records.front();
  record.name = "r1x_" + slug(name);
  EXPECT_EQ(propose_experiment(**asked.workspace, *asked.answer).segments.at(0).name, name) << "no name of ours";
  record.name = "r10_" + slug(name);
  for (const ExperimentSegment& s : propose_experiment(**asked.workspace, *asked.answer).segments) EXPECT_NE(s.name, name);
}

TEST(NextExperiment, AsksNothingOfEffectsThatTheAnswerDoesNotNameNorOfWhatIsKnown) {
  const LateOutput asked;
  ASSERT_TRUE(asked.answer.has_value()) << asked.answer.error().to_text();
  Diagnosis d = *asked.answer;
  d.findings.clear();
  EXPECT_TRUE(propose_experiment(**asked.workspace, d).segments.empty()) << "nobody named them";
  d = *asked.answer;
  for (Finding& f : d.findings) f.probability = f.effect == d.findings.front().effect ? 0.9 : 0.01;
  for (RankedEffect& r : d.ranking) r.score = r.effect == d.findings.front().effect ? 500.0 : 4.0;
  EXPECT_TRUE(propose_experiment(**asked.workspace, d).segments.empty()) << "90 to 1 already";
}

TEST(NextExperiment, AUsersOwnEquationIsARivalAsAnyOther) {
  EngineOptions options = LateOutput::options();
  options.user_effects = {{"own_lag", {{"k", "1", 1.0, 0.0, -5.0, 5.0, 0.0}, {"tau_s", "s", 0.06, 0.0, 0.01, 1.0, 0.06}}, {{"x", "(F - x) / tau_s"}}, "k * (x - F)"}};
  Campaign c = make_campaign(61, late);
  std::erase_if(c.records, [](const Record& r) { return r.kind != "ramp"; });
  const auto w = prepare(std::move(c), options);
  ASSERT_TRUE(w.has_value()) << w.error().to_text();
  Diagnosis d;
  d.findings = {finding("own_lag", 0.5), finding("delay", 0.45, "own_lag")};
  d.ranking = {ranked("own_lag", 500.0), ranked("delay", 499.0)};
  const NextExperiment next = propose_experiment(**w, d);
  ASSERT_FALSE(next.segments.empty());
  EXPECT_EQ(next.segments.front().separates, "own_lag / delay");
}

}  // namespace
}  // namespace forcegate::diagnose
