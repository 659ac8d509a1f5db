// An equation of the user's own whose output is a sum of parts: each has its strength, and none a factor that the records cannot tell.

#include "hil/diagnose/candidates/user_candidates.h"
#include "hil/diagnose/refit/refit.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

constexpr double kQuick_s = 3.0, kSlow_s = 60.0, kOfQuick = 0.05, kOfSlow = 0.08;

std::vector<double> two_poles(const std::vector<double>& t, const std::vector<double>& F, int) {
  std::vector<double> U;
  double x = 0.0, y = 0.0;
  for (std::size_t i = 0; i < F.size(); ++i) {
    if (i > 0) {
      x += (F[i] - x) * (t[i] - t[i - 1]) / kQuick_s;
      y += (F[i] - y) * (t[i] - t[i - 1]) / kSlow_s;
    }
    U.push_back(2.0 * (F[i] + kOfQuick * x + kOfSlow * y) + 0.2);
  }
  return U;
}

ModelParameter parameter(const char* name, double value) { return {name, "1", value, 0.0, -1e300, 1e300, 0.0}; }

Result<Refit> refit_with(const UserEffect& effect) {
  Model start;
  start.law.decays = false;
  start.user_effects = {effect};
  EngineOptions options;
  options.threads = 1;
  options.law = start.law;
  options.user_effects = start.user_effects;
  return refit_campaign(make_campaign(72, two_poles), options, start, effect.name);
}

TEST(SumOfParts, HasAStrengthForEachPart) {
  const auto refit = refit_with({"mine", {parameter("k1", 0.1), parameter("tau1", 2.0), parameter("k2", 0.1), parameter("tau2", 40.0)},
                                 {{"x", "(F - x) / tau1"}, {"y", "(F - y) / tau2"}}, "k1 * x + k2 * y"});
  ASSERT_TRUE(refit) << refit.error().to_text();
  const UserEffect& own = refit->model.user_effects.front();
  EXPECT_EQ(own.output, "k1 * x + k2 * y");
  ASSERT_EQ(own.parameters.size(), 4U);
  EXPECT_NEAR(own.parameters[0].value, kOfQuick, 0.02);
  EXPECT_NEAR(own.parameters[2].value, kOfSlow, 0.02);
  for (const std::size_t strength : {std::size_t{0}, std::size_t{2}}) EXPECT_LT(own.parameters[strength].se, 0.3 * own.parameters[strength].value) << strength;
}

TEST(SumOfParts, IsNoneWhereAPartBendsWithItsParameter) {
  const auto refit = refit_with({"mine", {parameter("k", 0.1), parameter("c", 0.1), parameter("tau", 40.0)}, {{"x", "(F - x) / tau"}}, "(1 + k * c) * x + c * F^2"});
  ASSERT_TRUE(refit) << refit.error().to_text();
  EXPECT_EQ(refit->model.user_effects.front().output, "share * ((1 + k * c) * x + c * F^2)");
}

}  // namespace
}  // namespace forcegate::diagnose
