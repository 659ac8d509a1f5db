// A shape of the user's own stays within two decades of what was written, however often a refit begins anew.

#include "hil/diagnose/candidates/user_candidates.h"
#include "hil/diagnose/refit/refit.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

std::vector<double> slow_pole(const std::vector<double>& t, const std::vector<double>& F, int) {
  std::vector<double> U;
  double x = 0.0;
  for (std::size_t i = 0; i < F.size(); ++i) {
    if (i > 0) x += (F[i] - x) * (t[i] - t[i - 1]) / 40.0;
    U.push_back(2.0 * (F[i] + 0.06 * x) + 0.2);
  }
  return U;
}

double fitted_tau(double written) {
  Model start;
  start.law.decays = false;
  start.user_effects = {{"mine", {{"k", "1", 0.01, 0.0, -1e300, 1e300, 0.0}, {"tau", "s", written, 0.0, -1e300, 1e300, 0.0}}, {{"x", "(F - x) / tau"}}, "k * x"}};
  EngineOptions options;
  options.threads = 1;
  options.law = start.law;
  options.user_effects = start.user_effects;
  const auto refit = refit_campaign(make_campaign(71, slow_pole), options, start, "mine");
  EXPECT_TRUE(refit.has_value()) << refit.error().to_text();
  return refit ? refit->model.user_effects.front().parameters.back().value : 0.0;
}

TEST(Reach, OfAShapeIsTwoDecadesAroundWhatWasWritten) {
  EXPECT_LE(fitted_tau(0.15), 15.0 * (1.0 + 1e-9));
  EXPECT_NEAR(fitted_tau(20.0), 40.0, 4.0);
}

TEST(Reach, IsKeptWhereAFitHasMovedTheValueAndEndsAtTheBounds) {
  ModelParameter p{"tau", "s", 2.0, 0.0, -1e300, 50.0, 0.0};
  EXPECT_DOUBLE_EQ(reach_of(p).low, 0.02);
  EXPECT_DOUBLE_EQ(reach_of(p).high, 50.0);
  p.written = 0.1;
  EXPECT_DOUBLE_EQ(reach_of(p).high, 10.0);
  p.value = p.written = -1.0, p.maximum = 1e300;
  EXPECT_DOUBLE_EQ(reach_of(p).low, -100.0);
  EXPECT_DOUBLE_EQ(reach_of(p).high, -0.01);
}

}  // namespace
}  // namespace forcegate::diagnose
