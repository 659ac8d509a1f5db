// Growth that the load itself hastens: ten times as fast under twice the load, and no sum of relaxations.

#include <cmath>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// Barriers that open at a rate of e^x - 1, x the load that is not taken up yet, in shares of 0.4 N.
std::vector<double> opening(const std::vector<double>& t, const std::vector<double>& F, int) {
  constexpr double kF0_N = 0.4, kTau_s = 400.0, kShare = 0.1;
  double y = 0.0;
  std::vector<double> U;
  for (std::size_t i = 0; i < F.size(); ++i) {
    const double x = (F[i] - y) / kF0_N, dt_s = i > 0 ? t[i] - t[i - 1] : 0.0;
    y += std::copysign(std::min(std::abs(F[i] - y), kF0_N / kTau_s * std::expm1(std::abs(x)) * dt_s), x);
    U.push_back(2.0 * (F[i] + kShare * y) + 0.2);
  }
  return U;
}

TEST(HastenedCreep, IsNamedAndLeavesLittle) {
  const Diagnosis d = answer(make_campaign(91, opening));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::known) << told(d);
  ASSERT_FALSE(d.findings.empty());
  EXPECT_EQ(d.findings.front().effect, "creep") << told(d);
  EXPECT_GE(d.findings.front().probability, 0.9) << told(d);
  EXPECT_LT(d.error_after, 2.0 * d.floor) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
