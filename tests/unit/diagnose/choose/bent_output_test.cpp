#include "hil/diagnose/choose/bent_output.h"

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

CampaignInput of_range(double low_N, double range_N) {
  CampaignInput out;
  out.lowest_N = low_N;
  out.range_N = range_N;
  return out;
}

Finding curve_of(const std::string& form, std::vector<FoundParameter> parameters) {
  Finding out;
  out.effect = "static_nonlinearity";
  out.form = form;
  out.parameters = std::move(parameters);
  return out;
}

TEST(Bend, FollowsTheClaimedCurveAndLeavesTheEndsWhereTheyAre) {
  const CampaignInput campaign = of_range(0.0, 4.0);
  const auto bend = bend_of(campaign, curve_of("polynomial", {{"c2", -0.4, 0.01, "1"}, {"c3", 0.0, 0.01, "1"}}));
  ASSERT_TRUE(bend);
  const auto expected = [](double F) { return (F - 0.4 * F * F / 4.0) / 0.6; };
  for (const double F : {0.0, 0.7, 2.0, 3.3, 4.0}) EXPECT_NEAR(bend->at(F), expected(F), 1e-4) << F;
  EXPECT_NEAR(bend->at(4.5), 4.0 + 0.5 * 0.2 / 0.6, 0.01) << "along the last slope";
  EXPECT_NEAR(bend->departure, 1.0 / 6.0, 1e-3) << "at mid force 2.67 of 4 instead of 2";
}

TEST(Bend, TakesFurtherFormsAndTheCurveOfOneThatLags) {
  const CampaignInput campaign = of_range(0.0, 4.0);
  const auto both = bend_of(campaign, curve_of("saturation", {{"F1_N", 2.0, 0.1, "N"}, {"width_N", 0.2, 0.1, "N"}, {"c", 0.0, 0.1, "1"}, {"polynomial.c2", -0.4, 0.01, "1"}}));
  const auto lagged = bend_of(campaign, curve_of("polynomial_before_lag", {{"tau_s", 0.05, 0.01, "s"}, {"c2", -0.4, 0.01, "1"}, {"c3", 0.0, 0.01, "1"}}));
  ASSERT_TRUE(both && lagged);
  for (const double F : {0.5, 2.0, 3.5}) {
    EXPECT_NEAR(both->at(F), (F - 0.1 * F * F) / 0.6, 1e-3);
    EXPECT_NEAR(lagged->at(F), both->at(F), 1e-3);
  }
}

TEST(Bend, ThatDoesNotRiseIsNone) {
  EXPECT_FALSE(bend_of(of_range(0.0, 4.0), curve_of("polynomial", {{"c2", -0.8, 0.01, "1"}})));
  EXPECT_FALSE(bend_of(of_range(0.0, 0.0), curve_of("polynomial", {{"c2", -0.1, 0.01, "1"}})));
}

TEST(BendForce, GoesThroughRowsAndSamplesOfEveryBlock) {
  CampaignInput campaign = of_range(0.0, 4.0);
  campaign.records.resize(2);
  for (RecordInput& r : campaign.records) r.recording = 3, r.F_min_N = 1.0, r.A_N = 1.0;
  RecordInput& whole = campaign.records.front();
  for (std::uint32_t k = 0; k < 40; ++k) {
    whole.fast_t_s.push_back(0.01 * k);
    whole.fast_F_N.push_back(0.1 * k);
    whole.row_begin.push_back(k);
  }
  whole.row_begin.push_back(40);
  whole.t_s = whole.fast_t_s;
  for (RecordInput& r : campaign.records) r.t_s = whole.t_s, r.F_N.assign(40, 0.0);
  const auto bend = bend_of(campaign, curve_of("polynomial", {{"c2", 0.5, 0.01, "1"}}));
  ASSERT_TRUE(bend);
  bend_force(campaign, *bend);
  const auto bent = [](double F) { return (F + 0.5 * F * F / 4.0) / 1.5; };
  for (const RecordInput& r : campaign.records) {
    for (std::size_t i = 0; i < 40; ++i) EXPECT_NEAR(r.F_N[i], bent(0.1 * static_cast<double>(i)), 1e-3) << i;
    EXPECT_NEAR(r.F_min_N, bent(1.0), 1e-3);
    EXPECT_NEAR(r.A_N, 0.5 * (bent(3.0) - bent(1.0)), 1e-3);
    EXPECT_GT(r.rate_N_per_s[20], 0.0);
  }
}

// A logger that is late behind a film that saturates: its lag in volts is longer at low load, as that of a parasitic RC.
TEST(BehindACurve, ADelayIsADelayAndNoParasiticRc) {
  constexpr std::size_t kLate = 4;
  constexpr double kDelay_s = 0.02;
  const Diagnosis d = answer(make_campaign(12, [](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double f = F[i < kLate ? 0 : i - kLate];
      U.push_back(0.2 + 14.0 * f / (f + 3.5));
    }
    return U;
  }));
  EXPECT_GE(probability(d, "static_nonlinearity"), 0.7) << told(d);
  ASSERT_GE(probability(d, "delay"), 0.7) << told(d);
  EXPECT_LT(probability(d, "rc"), 0.5) << told(d);
  EXPECT_LT(d.error_after, 2.0 * d.floor) << told(d);
  for (const RecordError& r : d.records) EXPECT_LT(r.after, r.before) << r.record << ": without the curve and the delay, and with them";
  const Finding& delay = *std::ranges::find(d.findings, "delay", &Finding::effect);
  EXPECT_EQ(delay.form, kBehindCurve) << "what comes next is --late, and no term of a model";
  EXPECT_EQ(delay.parameters.front().name, "delay_s");
  EXPECT_NEAR(delay.parameters.front().value, kDelay_s, 0.001);
}

}  // namespace
}  // namespace forcegate::diagnose
