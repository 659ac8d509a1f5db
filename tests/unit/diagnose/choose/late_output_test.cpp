#include "hil/diagnose/choose/late_output.h"

#include "hil/model/model.h"
#include "tests/unit/diagnose/behind_pole.h"
#include "tests/unit/diagnose/made_campaign.h"
#include "tests/unit/diagnose/options_of_model.h"

namespace forcegate::diagnose {
namespace {

// A film that bends, behind poles, on a logger that is late.
Sensor film(const std::vector<double>& taus_s, double delay_s) {
  return [=](const std::vector<double>& t, const std::vector<double>& F, int) {
    std::vector<double> y = F;
    for (const double tau_s : taus_s) y = behind_pole(t, y, tau_s);
    const auto late = static_cast<std::size_t>(std::lround(delay_s / (t[1] - t[0])));
    std::vector<double> U;
    for (std::size_t i = 0; i < y.size(); ++i) U.push_back(8.0 * std::pow(std::max(y[i < late ? 0 : i - late], 0.0) / 4.6, 0.75) + 0.2);
    return U;
  };
}

Diagnosis answer_of_fsr(const Sensor& sensor) {
  Campaign campaign = make_campaign(7, sensor);
  campaign.records.resize(4);
  auto out = diagnose_campaign(std::move(campaign), options_of(*library_model("fsr")));
  EXPECT_TRUE(out.has_value()) << (out ? "" : out.error().to_text());
  return out ? *out : Diagnosis{};
}

TEST(LateOutput, ADelayBehindTheLagIsNamedWithTheBendAndWithItsLength) {
  const Diagnosis d = answer_of_fsr(film({0.06}, 0.04));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::known) << told(d);
  EXPECT_GE(probability(d, "static_nonlinearity"), 0.9) << told(d);
  EXPECT_GE(probability(d, "delay"), 0.9) << told(d);
  EXPECT_LT(d.error_after, 1.5 * d.floor) << told(d);
  const Finding& delay = *std::ranges::find(d.findings, "delay", &Finding::effect);
  ASSERT_FALSE(delay.parameters.empty());
  const FoundParameter& length = delay.parameters.front();
  EXPECT_EQ(length.name, "delay_s");
  EXPECT_NEAR(length.value, 0.04, 3.0 * length.u + 0.001);
  EXPECT_GT(length.u, 0.0);
  EXPECT_LT(length.u, 0.004);
  EXPECT_LT(delay.error_after, 0.8 * delay.error_before);
}

// The delay may grow by what the lag loses: whoever moves one of them at a time comes to rest half-way.
TEST(LateOutput, ALongDelayBehindAShortLagIsNotSharedBetweenThem) {
  constexpr double kLag_s = 0.004, kDelay_s = 0.06;
  const Diagnosis d = answer_of_fsr(film({kLag_s}, kDelay_s));
  ASSERT_GE(probability(d, "delay"), 0.9) << told(d);
  const FoundParameter& length = std::ranges::find(d.findings, "delay", &Finding::effect)->parameters.front();
  EXPECT_NEAR(length.value, kDelay_s, kLag_s + 0.002) << length.u;
  EXPECT_LT(length.u, 0.003);
  EXPECT_LT(d.error_after, 1.5 * d.floor) << told(d);
}

TEST(LateOutput, TwoPolesAreNoDelay) {
  const Diagnosis d = answer_of_fsr(film({0.05, 0.04}, 0.0));
  EXPECT_LT(probability(d, "delay"), 0.5) << told(d);
}

TEST(LateOutput, WhatTwoClocksMayDifferByIsNoFinding) {
  const Diagnosis d = answer_of_fsr(film({0.06}, 0.005));
  EXPECT_LT(probability(d, "delay"), 0.5) << told(d);
}

TEST(DelayForce, IsTheForceOfSoMuchEarlierInEveryRowAndBlock) {
  CampaignInput campaign;
  campaign.records.resize(2);
  constexpr double kStep_s = 0.01, kDelay_s = 0.025;
  const auto force = [](double t) { return 2.0 + 3.0 * t; };
  for (RecordInput& r : campaign.records) r.recording = 4;
  RecordInput& whole = campaign.records.front();
  for (std::uint32_t k = 0; k < 50; ++k) {
    whole.fast_t_s.push_back(kStep_s * k);
    whole.fast_F_N.push_back(force(kStep_s * k));
    if (k % 2 == 0) whole.row_begin.push_back(k), whole.t_s.push_back(kStep_s * (k + 0.5));
  }
  whole.row_begin.push_back(50);
  whole.wanted = {3};
  for (RecordInput& r : campaign.records) r.t_s = whole.t_s, r.F_N.assign(r.t_s.size(), 0.0);
  delay_force(campaign, kDelay_s);
  for (std::size_t k = 5; k < 50; ++k) EXPECT_NEAR(whole.fast_F_N[k], force(kStep_s * static_cast<double>(k) - kDelay_s), 1e-12) << k;
  EXPECT_EQ(whole.fast_F_N.front(), force(0.0)) << "nobody knows what was before";
  for (const RecordInput& r : campaign.records)
    for (std::size_t i = 3; i < r.rows(); ++i) EXPECT_NEAR(r.F_N[i], force(r.t_s[i] - kDelay_s), 1e-12) << i;
}

}  // namespace
}  // namespace forcegate::diagnose
