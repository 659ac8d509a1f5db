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

EngineOptions options_of(const Model& model) {
  EngineOptions options;
  options.threads = 1;
  options.law = model.law;
  options.in_model = model.effect_names();
  options.model_effects = model.effects;
  return options;
}

TEST(Refit, ADiagnosisWithTheModelBeginsWhereItsRefitEnded) {
  const auto added = refit(make_campaign(71, looped, 0.002), "hysteresis");
  ASSERT_TRUE(added) << added.error().to_text();
  const auto d = diagnose_campaign(make_campaign(71, looped, 0.002), options_of(added->model));
  ASSERT_TRUE(d) << d.error().to_text();
  EXPECT_EQ(d->verdict, DiagnosisVerdict::none) << told(*d);
  EXPECT_NEAR(d->error_before, added->error_after, 0.05 * added->error_after);
}

TEST(Refit, TheSecondEffectIsStillThereWhenTheFirstIsInTheModel) {
  const Sensor both = [](const std::vector<double>& t, const std::vector<double>& F, int record) {
    std::vector<double> U = looped(t, F, record);
    double slow = F.front();
    for (std::size_t i = 0; i < U.size(); ++i) {
      slow += (F[i] - slow) * -std::expm1(-(i > 0 ? t[i] - t[i - 1] : 0.005) / 40.0);
      U[i] += 0.12 * slow;
    }
    return U;
  };
  for (const auto& [first, second] : {std::pair{"hysteresis", "creep"}, std::pair{"creep", "hysteresis"}}) {
    const auto added = refit(make_campaign(73, both, 0.002), first);
    ASSERT_TRUE(added) << added.error().to_text();
    const auto d = diagnose_campaign(make_campaign(73, both, 0.002), options_of(added->model));
    ASSERT_TRUE(d) << d.error().to_text();
    EXPECT_GE(probability(*d, second), 0.9) << told(*d);
  }
}

TEST(Refit, OneRecordingThatItsModelDescribesIsJudgedAsAWhole) {
  // the rail is met in one part only: from the others nobody can foretell it
  const auto recording = [] {
    Campaign c = make_campaign(74, straight, 0.002);
    c.records.resize(1);
    c.records.front().kind.clear();
    c.records.front().dynamic.reset();
    Trace& trace = c.records.front().trace;
    Rng rng(74, "rail");
    for (std::size_t i = 0; i < trace.channels[0].value.size(); ++i) {
      const double t = trace.time_bases[0].t_s[i], f = (t < 60.0 ? 2.0 : 3.6) * (0.1 + 0.9 * std::abs(std::sin(0.11 * t)));
      trace.channels[0].value[i] = f;
      trace.channels[1].value[i] = std::min(2.0 * f + 0.2, 6.1) + 0.002 * rng.normal();
    }
    return c;
  };
  EngineOptions options;
  options.threads = 1;
  const auto added = refit_campaign(recording(), options, *library_model("flexiforce"), "clipping");
  ASSERT_TRUE(added) << added.error().to_text();
  const auto d = diagnose_campaign(recording(), options_of(added->model));
  ASSERT_TRUE(d) << d.error().to_text();
  EXPECT_LT(d->error_before, 2.0 * added->error_after);
  EXPECT_NE(d->verdict, DiagnosisVerdict::known) << told(*d);
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
