// A claim that leaves much of the error well above the noise is no name, near the noise as far from it.

#include "hil/diagnose/answer/explains_little.h"

#include <cmath>
#include <numbers>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// A bent film whose gain swings by a law of its own.
Sensor bent_and_swinging(double bend_V, double swing) {
  return [=](const std::vector<double>& t, const std::vector<double>& F, int record) {
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double x = F[i] / 4.4, phase = 2.0 * std::numbers::pi * (t[i] / 7.3 + 0.37 * record);
      U.push_back((2.0 * F[i]) * (1.0 + swing * std::sin(phase + std::sin(0.31 * phase))) + 0.2 + bend_V * 4.0 * x * (1.0 - x));
    }
    return U;
  };
}

TEST(ExplainsLittle, ACurveBesideSomethingLargerWithoutANameIsNoName) {
  const Diagnosis d = answer(make_campaign(31, bent_and_swinging(0.08, 0.007)));
  EXPECT_LT(d.error_after, 2.5 * d.floor) << "not far above the noise";
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
  EXPECT_LT(probability(d, "static_nonlinearity"), 0.5) << told(d);
}

TEST(ExplainsLittle, ACurveThatLeavesLittleIsNamed) {
  const Diagnosis d = answer(make_campaign(31, bent_and_swinging(0.08, 0.002)));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::known) << told(d);
  EXPECT_GE(probability(d, "static_nonlinearity"), 0.9) << told(d);
}

// The claim of an effect between records of which left-out records keep `left` of their error, while their gains scatter by `gains`.
double probability_of_drift(const std::string& name, double left, double gains) {
  EffectKind kind;
  kind.name = name;
  ResidualChannel channel;
  channel.problem.component_of_z = {0, 1};
  Selection selection;
  selection.claimed.valid = true;
  selection.claimed.variance = Eigen::Vector2d(gains * gains, 1e-6);
  ChosenEffect chosen;
  chosen.kind = &kind;
  chosen.between = true;
  chosen.error_before = 1.0;
  chosen.error_after = left;
  selection.chosen.push_back(chosen);
  std::vector<Finding> findings(1);
  findings[0].effect = name;
  findings[0].probability = 0.9;
  withdraw_drifts_beside_wide_gains(channel, selection, findings);
  return findings[0].probability;
}

TEST(ExplainsLittle, AZeroThatDriftsBesideGainsThatScatterFarMoreIsASuspicion) {
  EXPECT_LT(probability_of_drift("reference_drift", 0.85, 0.2), 0.5);
  EXPECT_EQ(probability_of_drift("reference_drift", 0.6, 0.2), 0.9);
  EXPECT_EQ(probability_of_drift("reference_drift", 0.85, 0.01), 0.9);
  EXPECT_EQ(probability_of_drift("thermal", 0.85, 0.2), 0.9);
}

}  // namespace
}  // namespace forcegate::diagnose
