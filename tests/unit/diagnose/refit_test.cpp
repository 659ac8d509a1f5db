// `add` measures as `diagnose` does, and a law is refitted to what the records show.

#include "hil/diagnose/refit.h"

#include "hil/model/model.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// A loop of 0.15 N: a play in front of the film.
std::vector<double> looped(const std::vector<double>&, const std::vector<double>& F, int) {
  std::vector<double> U;
  double y = F.front();
  for (const double f : F) {
    y = std::clamp(y, f - 0.075, f + 0.075);
    U.push_back(2.0 * (0.5 * f + 0.5 * y) + 0.2);
  }
  return U;
}

Result<Refit> refit(Campaign campaign, const std::string& add) {
  EngineOptions options;
  options.threads = 1;
  FORCEGATE_TRY(const auto workspace, prepare(std::move(campaign), options));
  FORCEGATE_TRY(const Model model, library_model("flexiforce"));
  return refit_model(*workspace, model, add, 1);
}

TEST(Refit, StartsFromTheErrorsOfTheDiagnosisThatLedToIt) {
  const Diagnosis d = answer(make_campaign(71, looped, 0.002));
  ASSERT_GE(probability(d, "hysteresis"), 0.5) << told(d);
  const auto added = refit(make_campaign(71, looped, 0.002), "hysteresis");
  ASSERT_TRUE(added) << added.error().to_text();
  EXPECT_NEAR(added->error_before, d.error_before, 0.01 * d.error_before);
  EXPECT_NEAR(added->plain_before, d.plain_before, 0.01 * d.plain_before);
  EXPECT_LT(added->error_after, 1.1 * d.error_after);  // the forms are chosen anew
}

TEST(Refit, ASwingThatDoesNotDecayLeavesAStaticLaw) {
  Campaign c = make_campaign(72, straight, 0.002);
  for (Record& r : c.records) {
    r.kind.clear();
    r.dynamic.reset();
  }
  const auto made = refit(std::move(c), "");
  ASSERT_TRUE(made) << made.error().to_text();
  EXPECT_FALSE(made->model.law.decays);
}

}  // namespace
}  // namespace forcegate::diagnose
