// Terms of a creep that no record is long enough to tell are not fitted.

#include "hil/diagnose/refit/seen_terms.h"

#include <gmock/gmock.h>

#include "hil/diagnose/refit/refit.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

TEST(SeenTerms, AreThoseOfWhichARecordIsHalfAsLong) {
  const EffectForm* form = find_form(*EffectRegistry::instance().find("creep"), "prony");
  ASSERT_NE(form, nullptr);
  CampaignInput input;
  input.records.resize(2);
  input.records[0].duration_s = 60.0, input.records[1].duration_s = 149.0;
  const auto seen = [&] {
    std::size_t n = 0;
    for (std::size_t k = 0; k < form->strength.size(); ++k) n += is_seen(*form, k, input) ? 1U : 0U;
    return n;
  };
  EXPECT_EQ(seen(), 5U);  // 1 to 100 s
  input.records[1].duration_s = 150.0;
  EXPECT_EQ(seen(), 6U);
  input.records[0].duration_s = 600.0;
  EXPECT_EQ(seen(), 7U);
}

// Records of two minutes of a film without a decay, and a creep in its model.
Result<Refit> with_creep(const Sensor& film) {
  Model start;
  start.law.decays = false;
  EngineOptions options;
  options.threads = 1;
  options.law = start.law;
  return refit_campaign(make_campaign(73, film), options, start, "creep");
}

// Two exponentials that no power law describes.
TEST(SeenTerms, AreTheOnlyOnesThatAModelGets) {
  const auto film = [](const std::vector<double>& t, const std::vector<double>& F, int) {
    std::vector<double> U;
    double quick = 0.0, slow = 0.0;
    for (std::size_t i = 0; i < F.size(); ++i) {
      if (i > 0) {
        quick += (F[i] - quick) * (t[i] - t[i - 1]) / 1.0;
        slow += (F[i] - slow) * (t[i] - t[i - 1]) / 80.0;
      }
      U.push_back(2.0 * (F[i] + 0.05 * quick + 0.1 * slow) + 0.2);
    }
    return U;
  };
  const auto refit = with_creep(film);
  ASSERT_TRUE(refit) << refit.error().to_text();
  bool any = false;
  for (const ModelEffect& effect : refit->model.effects) {
    const EffectForm* form = find_form(*EffectRegistry::instance().find("creep"), effect.form);
    ASSERT_NE(form, nullptr);
    for (std::size_t k = 0; k < form->memory_s.size(); ++k) {
      any = true;
      if (form->memory_s[k] > 240.0) {
        EXPECT_EQ(effect.strength[k].value, 0.0) << form->strength[k].name;
      }
    }
  }
  EXPECT_TRUE(any);
  EXPECT_THAT(refit->notes, ::testing::Contains(::testing::HasSubstr("terms of 300 s and longer are left out, since the longest record has 120 s")));
}

// A form that comes beside the first one brings its columns one by one.
TEST(SeenTerms, StayOutThoughAFurtherFormHasThem) {
  for (const double share : {0.05, 0.3}) {
    const auto refit = with_creep([share](const std::vector<double>& t, const std::vector<double>& F, int) {
      std::vector<double> U;
      double y = 0.0;
      for (std::size_t i = 0; i < F.size(); ++i) {
        if (i > 0) y += (F[i] - y) * (t[i] - t[i - 1]) / 50.0;
        U.push_back(2.0 * (F[i] + share * y) + 0.2);
      }
      return U;
    });
    ASSERT_TRUE(refit) << refit.error().to_text();
    const bool told = std::ranges::any_of(refit->notes, [](const std::string& note) { return note.find("terms of 300 s and longer are left out") != std::string::npos; });
    for (const ModelEffect& effect : refit->model.effects)
      for (const ModelParameter& p : effect.strength)
        if (p.name == "k_300s" || p.name == "k_1000s") {
          EXPECT_TRUE(!told || p.value == 0.0) << share << ": " << p.name << " = " << p.value;
        }
  }
}

}  // namespace
}  // namespace forcegate::diagnose
