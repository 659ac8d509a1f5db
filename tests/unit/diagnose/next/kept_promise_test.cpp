// What the next experiment promises is what the rule of probability makes of the record that was asked for.

#include "hil/diagnose/next/expected_odds.h"
#include "hil/diagnose/next/next_experiment.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

constexpr double kPole_s = 40.0;

// One slow pole: the poles of creep imitate it wherever the force goes.
std::vector<double> one_pole(const std::vector<double>& t, const std::vector<double>& F, int) {
  std::vector<double> U;
  double x = 0.0;
  for (std::size_t i = 0; i < F.size(); ++i) {
    if (i > 0) x += (F[i] - x) * (t[i] - t[i - 1]) / kPole_s;
    U.push_back(2.0 * (F[i] + 0.06 * x) + 0.2);
  }
  return U;
}

struct OnePole {
  EngineOptions options = [] {
    EngineOptions out;
    out.threads = 1;
    out.user_effects = {{"mine", {{"k", "1", 0.01, 0.0, -1e300, 1e300, 0.0}, {"tau", "s", 20.0, 0.0, -1e300, 1e300, 20.0}}, {{"x", "(F - x) / tau"}}, "k * x"}};
    return out;
  }();
  Result<std::unique_ptr<Workspace>> workspace = prepare(make_campaign(71, one_pole), options);
  Result<Diagnosis> answer = workspace ? diagnose_workspace(**workspace, options) : Result<Diagnosis>(Unexpected(workspace.error()));
};

double score(const Diagnosis& d, const std::string& effect) {
  const auto at = std::ranges::find(d.ranking, effect, &RankedEffect::effect);
  return at == d.ranking.end() ? 0.0 : at->score;
}

TEST(KeptPromise, OddsAreThoseOfTheEvidenceByTheRuleOfTheShares) {
  const OnePole asked;
  ASSERT_TRUE(asked.answer.has_value()) << asked.answer.error().to_text();
  const auto odds = rival_odds(*asked.answer, "mine", "creep");
  ASSERT_TRUE(odds.has_value() && odds->stated) << told(*asked.answer);
  const double evidence = evidence_between(*asked.answer, "mine", "creep"), top = std::max(score(*asked.answer, "mine"), score(*asked.answer, "creep"));
  EXPECT_NEAR(odds->log_odds, evidence / nats_of_a_factor(top), 0.02) << told(*asked.answer);
}

TEST(KeptPromise, NothingIsPromisedWhereTheRivalImitatesEverySegment) {
  const OnePole asked;
  ASSERT_TRUE(asked.answer.has_value()) << asked.answer.error().to_text();
  const NextExperiment next = propose_experiment(**asked.workspace, *asked.answer);
  EXPECT_TRUE(next.segments.empty()) << next.sentence;
  EXPECT_NE(next.sentence.find("none of the short segments that a rig can play parts mine or creep"), std::string::npos) << next.sentence;
}

// A lead that is small beside what the records so far hold is worth little at their temperature, however plain it is by itself.
TEST(KeptPromise, AFurtherRecordCountsAtTheTemperatureOfAllTheEvidence) {
  Workspace w;
  Diagnosis d;
  d.findings.resize(2);
  d.findings[0].effect = "creep", d.findings[0].probability = 0.6;
  d.findings[1].effect = "lag", d.findings[1].probability = 0.3, d.findings[1].rival_of = "creep";
  d.ranking.resize(2);
  d.ranking[0].effect = "creep", d.ranking[0].score = 1500.0;
  d.ranking[1].effect = "lag", d.ranking[1].score = 1460.0;
  EffectKind creep, lag;
  creep.name = "creep", lag.name = "lag";
  Hypothesis held;
  held.precision = Eigen::MatrixXd::Identity(1, 1);
  const Rival leader{&creep, {held}, 0.9, 0.0}, other{&lag, {held}, 0.9, 0.0};
  Imitation record;
  record.samples = 100.0, record.size = 400.0;
  record.forms = {{Eigen::MatrixXd::Zero(1, 1), Eigen::VectorXd::Zero(1), 100.0}};
  const RivalOdds now{std::log(2.0), true};
  const double evidence = 50.0 * std::log(2.0), with_record = 50.0 * std::log(5.0);
  const Expected after = expected_odds(w, d, now, leader, other, record);
  EXPECT_NEAR(after.log_odds, (std::log(2.0) * 51.0 + evidence) / (0.03 * (1500.0 + with_record) + 6.0), 1e-9);
  EXPECT_LT(std::exp(after.log_odds), 4.0) << "the exponential of 35 nats would be over 50";
  EXPECT_NEAR(after.likeness, std::sqrt(0.75), 1e-9);
  // a rival that is free to follow is not parted
  record.forms.front() = {Eigen::MatrixXd::Constant(1, 1, 1e9), Eigen::VectorXd::Constant(1, std::sqrt(100.0 * 1e9)), 100.0};
  EXPECT_LT(expected_odds(w, d, now, leader, other, record).log_odds, now.log_odds);
}

TEST(KeptPromise, LaterOddsAreToldByTheMeasureOfTheEarlierOnes) {
  Diagnosis d;
  d.findings.resize(1);
  d.findings[0].effect = "creep", d.findings[0].probability = 0.98;
  d.ranking.resize(2);
  d.ranking[0].effect = "creep", d.ranking[0].score = 1000.0;
  d.ranking[1].effect = "lag", d.ranking[1].score = 964.0;
  EXPECT_NEAR(rival_odds_as(true, d, "creep", "lag")->log_odds, 1.0, 1e-12);
  EXPECT_NEAR(rival_odds_as(false, d, "creep", "lag")->log_odds, 20.0, 1e-12);
}

}  // namespace
}  // namespace forcegate::diagnose
