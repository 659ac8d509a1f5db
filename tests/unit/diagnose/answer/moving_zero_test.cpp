// A zero that moves within every record of a campaign: every fit gives it to the records, and yet something is there.

#include "hil/diagnose/answer/moving_zero.h"

#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

// What a zero that goes with the time in each record, by `rate_V_per_s`, is called.
Diagnosis of_zero(double rate_V_per_s) {
  return answer(make_campaign(
      31,
      [&](const std::vector<double>& t, const std::vector<double>& F, int) {
        std::vector<double> U;
        for (std::size_t i = 0; i < F.size(); ++i) U.push_back(1.8 * F[i] + 0.8 + rate_V_per_s * t[i]);
        return U;
      }));
}

TEST(MovingZero, OfEveryRecordIsUnknown) {
  for (const double rate_V_per_s : {-0.002, 0.002}) {
    const Diagnosis d = of_zero(rate_V_per_s);
    EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
    const auto drift = std::ranges::find(d.findings, std::string("reference_drift"), &Finding::effect);
    ASSERT_NE(drift, d.findings.end()) << told(d);
    EXPECT_FALSE(drift->claimed()) << told(d);
    EXPECT_FALSE(drift->side_witnessed);
    EXPECT_NEAR(d.repeatability.wander_V, 0.24 / std::sqrt(12.0), 0.02);
  }
}

TEST(MovingZero, ThatStandsIsNone) {
  const Diagnosis d = of_zero(0.0);
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_LT(d.repeatability.wander_V, 1e-3 * 8.8);
}

// A zero that settles in a minute under a load that cycles on: within its parts a creep explains it as well, and is withdrawn for its size there.
TEST(MovingZero, OfOneRecordingIsToldWholeAndIsNoNone) {
  Campaign campaign = recording(
      20.0, 6000, [](double t_s) { return 2.0 + (t_s > 20.0 ? 1.2 * std::sin(0.314 * t_s) : 0.0) + (t_s > 150.0 ? 1.0 : 0.0); },
      [](const std::vector<double>& t, const std::vector<double>& F) {
        std::vector<double> U;
        for (std::size_t i = 0; i < F.size(); ++i) U.push_back(0.4 * F[i] + 0.05 - 0.05 * std::expm1(-std::max(0.0, t[i] - 20.0) / 40.0));
        return U;
      },
      0.002);
  Rng rng(8, "reference");
  for (double& f : campaign.records.front().trace.find("F_ref")->value) f += 0.005 * rng.normal();
  const Diagnosis d = answer(std::move(campaign));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
  const auto drift = std::ranges::find(d.findings, std::string("reference_drift"), &Finding::effect);
  ASSERT_NE(drift, d.findings.end()) << told(d);
  EXPECT_FALSE(drift->claimed());
  EXPECT_TRUE(drift->evidence.find("moves by 3") != std::string::npos || drift->evidence.find("moves by 4") != std::string::npos) << drift->evidence;
}

TEST(MovingZero, ACreepSmallerThanItIsItsOwn) {
  Workspace w;
  w.output.scale = 10.0;
  MixedFit fit;
  fit.zeta.assign(3, Eigen::VectorXd::Zero(15));
  for (Eigen::VectorXd& zeta : fit.zeta) zeta[11] = 0.01;  // the first wave: 0.07 V RMS
  std::vector<Finding> findings(1);
  findings[0].effect = "creep";
  for (const double size_V : {0.08, 0.06}) {
    findings[0].probability = 0.98;
    findings[0].effect_rms = size_V;
    leave_creep_to_moving_zero(w, fit, findings);
    EXPECT_EQ(findings[0].claimed(), size_V > 0.07);
  }
  EXPECT_TRUE(findings[0].name_is_open);
}

TEST(MovingZero, IsToldInTheUnitOfTheOutput) {
  MixedFit fit;
  fit.zeta.assign(3, Eigen::VectorXd::Zero(15));
  for (Eigen::VectorXd& zeta : fit.zeta) zeta[11] = 0.01;
  for (const auto& [unit, printed] : {std::pair{"V", " mV within"}, std::pair{"counts", " counts within"}}) {
    Workspace w;
    w.output.scale = 10.0;
    w.output.unit = unit;
    const std::optional<MovingZero> told = moving_zero_of_records(w, fit);
    ASSERT_TRUE(told);
    EXPECT_NE(told->finding.evidence.find(printed), std::string::npos) << told->finding.evidence;
  }
}

}  // namespace
}  // namespace forcegate::diagnose
