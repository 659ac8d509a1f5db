// Effects of a model are fitted each beside the others: a guess that lags, fitted without the curve that is to be added, would take the curve's part.

#include <cmath>

#include "hil/diagnose/engine.h"
#include "hil/diagnose/refit/refit.h"
#include "hil/model/model.h"
#include "tests/unit/diagnose/behind_pole.h"
#include "tests/unit/diagnose/made_campaign.h"
#include "tests/unit/diagnose/options_of_model.h"

namespace forcegate::diagnose {
namespace {

constexpr double kLag_s = 0.03, kNoise_V = 0.002;

// The power of an FSR behind its lag.
std::vector<double> bent_and_late(const std::vector<double>& t, const std::vector<double>& F, int) {
  std::vector<double> U;
  for (const double y : behind_pole(t, F, kLag_s)) U.push_back(2.5 * std::pow(std::max(y, 0.0), 0.65) + 0.1);
  return U;
}

class BesideEachOther : public testing::Test {
 protected:
  Result<Refit> add_to(const Model& model, const char* effect) { return refit_campaign(make_campaign(31, bent_and_late, kNoise_V), options_of(model), model, effect); }
};

TEST_F(BesideEachOther, ACurveIsAddedToAGuessAsTheDiagnosisShowsIt) {
  const Model fsr = *library_model("fsr");
  const auto added = add_to(fsr, "static_nonlinearity");
  ASSERT_TRUE(added) << added.error().to_text();
  EXPECT_LT(added->error_after, 1.3 * added->floor);
  EXPECT_LT(added->error_after, 0.1 * added->error_before);
  const auto lag = std::ranges::find(added->model.effects, std::string("lag"), &ModelEffect::effect);
  ASSERT_NE(lag, added->model.effects.end());
  EXPECT_EQ(lag->form, "one_pole");
  EXPECT_NEAR(lag->shape.front().value, kLag_s, 0.15 * kLag_s);

  const auto d = diagnose_campaign(make_campaign(31, bent_and_late, kNoise_V), options_of(fsr));
  ASSERT_TRUE(d) << d.error().to_text();
  ASSERT_FALSE(d->findings.empty());
  EXPECT_NEAR(added->error_before, d->error_before, 0.1 * d->error_before);
  EXPECT_LT(added->error_after, 1.2 * d->error_after);
}

TEST_F(BesideEachOther, NothingIsMissingOfWhatWasAdded) {
  const auto added = add_to(*library_model("fsr"), "static_nonlinearity");
  ASSERT_TRUE(added) << added.error().to_text();
  const auto d = diagnose_campaign(make_campaign(31, bent_and_late, kNoise_V), options_of(added->model));
  ASSERT_TRUE(d) << d.error().to_text();
  EXPECT_EQ(d->verdict, DiagnosisVerdict::none);
  EXPECT_LT(d->error_before, 1.3 * d->floor);
}

// Law and effects are fitted in the order of the file else: the lag that stands first would go on taking what the curve gives.
TEST_F(BesideEachOther, ARefitOfBothStandsStill) {
  const auto added = add_to(*library_model("fsr"), "static_nonlinearity");
  ASSERT_TRUE(added) << added.error().to_text();
  const auto again = add_to(added->model, "");
  ASSERT_TRUE(again) << again.error().to_text();
  EXPECT_LT(again->error_after, 1.05 * added->error_after);
  for (std::size_t k = 0; k < added->model.effects.size(); ++k) EXPECT_EQ(again->model.effects[k].form, added->model.effects[k].form);
}

}  // namespace
}  // namespace forcegate::diagnose
