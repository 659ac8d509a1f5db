// A refit ends where none of its parameters moves any more, and its errors before are those of the model before.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "hil/diagnose/engine.h"
#include "hil/diagnose/refit/added_effect.h"
#include "hil/diagnose/refit/refit.h"
#include "tests/unit/diagnose/creeping_campaign.h"
#include "tests/unit/diagnose/made_campaign.h"
#include "tests/unit/diagnose/options_of_model.h"

namespace forcegate::diagnose {
namespace {

TEST(SettledRefit, AnEffectThatIsMistakenForDecayLeavesTheLawWhereItIs) {
  for (const std::uint64_t seed : {1u, 2u}) {
    const Model library = *library_model("flexiforce");
    const auto added = refit_campaign(creeping(seed), options_of(library), library, "creep");
    ASSERT_TRUE(added) << added.error().to_text();
    EXPECT_NEAR(added->model.law.b_scale, 1.0, 0.05) << seed;
    EXPECT_NEAR(added->model.law.q_scale, 1.0, 0.05) << seed;
  }
}

TEST(SettledRefit, ARefitOfWhatWasRefittedChangesNothing) {
  const Model library = *library_model("flexiforce");
  const auto added = refit_campaign(creeping(3), options_of(library), library, "creep");
  ASSERT_TRUE(added) << added.error().to_text();
  const auto again = refit_campaign(creeping(3), options_of(added->model), added->model, "");
  ASSERT_TRUE(again) << again.error().to_text();
  for (const ParameterMove& m : again->moves) EXPECT_NEAR(m.after, m.before, 0.03 * m.u) << m.name;
  EXPECT_NEAR(again->error_after, added->error_after, 0.03 * added->error_after);  // records follow by the spreads of the law there, of the model here
  EXPECT_NEAR(again->plain_after, added->plain_after, 0.01 * added->plain_after);
}

TEST(SettledRefit, TellsErrorsInTheUnitOfTheOutput) {
  Campaign c = creeping(1);
  for (Record& r : c.records) r.trace.find("U")->unit = "S";
  const Model library = *library_model("flexiforce");
  const auto added = refit_campaign(std::move(c), options_of(library), library, "creep");
  ASSERT_TRUE(added) << added.error().to_text();
  EXPECT_EQ(added->waterfall.unit, "S");
  EXPECT_EQ(added->model.history.back().unit, "S");
}

// No record decays: the spreads of the records and the shares of a bank of plays are found from where a fit begins.
TEST(SettledRefit, NorDoesOneOfAStaticLaw) {
  const Sensor looped = [](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    std::array<double, 3> play{F.front(), F.front(), F.front()};
    for (const double f : F) {
      double sum = 0.0;
      for (std::size_t k = 0; k < play.size(); ++k) sum += play[k] = std::clamp(play[k], f - 0.3 * static_cast<double>(k + 1), f + 0.3 * static_cast<double>(k + 1));
      U.push_back(2.0 * (0.85 * f + 0.05 * sum) + 0.2);
    }
    return U;
  };
  const Model library = *library_model("flexiforce");
  const auto added = refit_campaign(make_campaign(77, looped, 0.002), options_of(library), library, "hysteresis");
  ASSERT_TRUE(added) << added.error().to_text();
  const auto again = refit_campaign(make_campaign(77, looped, 0.002), options_of(added->model), added->model, "");
  ASSERT_TRUE(again) << again.error().to_text();
  for (const ParameterMove& m : again->moves) EXPECT_NEAR(m.after, m.before, 0.03 * m.u + 1e-9) << m.name;
}

// What is added begins where the refit of the model without it ended; what is refitted, at the law alone.
TEST(SettledRefit, ErrorsBeforeAreThoseOfTheModelBefore) {
  const Model library = *library_model("flexiforce");
  const auto law = refit_campaign(creeping(4), options_of(library), library, "");
  ASSERT_TRUE(law) << law.error().to_text();
  const auto added = refit_campaign(creeping(4), options_of(law->model), law->model, "creep");
  ASSERT_TRUE(added) << added.error().to_text();
  const auto again = refit_campaign(creeping(4), options_of(added->model), added->model, "");
  ASSERT_TRUE(again) << again.error().to_text();
  EXPECT_NEAR(added->plain_before, law->plain_after, 0.05 * law->plain_after);
  EXPECT_NEAR(again->plain_before, law->plain_after, 0.2 * law->plain_after);  // from another start
  for (const Refit* r : {&*added, &*again}) {
    EXPECT_NEAR(r->error_before, law->error_after, 0.02 * law->error_after);
    EXPECT_DOUBLE_EQ(r->waterfall.start, r->error_before);
    EXPECT_DOUBLE_EQ(r->waterfall.end, r->error_after);
  }
}

// Of the page, whose records are shown before and after.
TEST(SettledRefit, IsShownWithTheErrorsThatItHas) {
  const Model library = *library_model("flexiforce");
  const auto added = refit_campaign(creeping(5), options_of(library), library, "creep");
  ASSERT_TRUE(added) << added.error().to_text();
  EngineOptions at_end = options_of(added->model), at_start = at_end;
  at_end.search = at_start.search = false;
  at_start.law = library.law;
  at_start.model_effects.clear();
  const auto start = prepare(creeping(5), at_start), end = prepare(creeping(5), at_end);
  ASSERT_TRUE(start && end);
  auto shown = show_added(**start, options_of(library), "creep");
  const auto settled = show_added(**end, options_of(library), "creep");
  ASSERT_TRUE(shown && settled);
  take_after(*settled, *shown);
  EXPECT_NEAR(shown->plain_before, added->plain_before, 0.02 * added->plain_before);
  EXPECT_NEAR(shown->plain_after, added->plain_after, 0.02 * added->plain_after);
  EXPECT_NEAR(shown->error_after, added->error_after, 0.02 * added->error_after);
}

}  // namespace
}  // namespace forcegate::diagnose
