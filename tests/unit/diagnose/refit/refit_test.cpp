// `add` measures as `diagnose` does, and a law is refitted to what the records show.

#include "hil/diagnose/refit/refit.h"

#include <numbers>

#include "hil/model/model.h"
#include "tests/unit/diagnose/made_campaign.h"
#include "tests/unit/diagnose/made_recording.h"
#include "tests/unit/diagnose/options_of_model.h"

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

// A gain that follows the largest force so far.
std::vector<double> softening(const std::vector<double>&, const std::vector<double>& F, int) {
  std::vector<double> U;
  double most = 0.0;
  for (const double f : F) {
    most = std::max(most, f);
    U.push_back(2.0 * (f + 0.02 * (most - f) * f) + 0.2);
  }
  return U;
}

Result<Refit> refit_own(const std::string& equation) {
  const auto model = parse_model("[law]\nkind = \"static\"\ngain_N_per_V = 0.5\n[[effect]]\nname = \"mine\"\n" + equation, "m.toml");
  if (!model) return Unexpected(model.error());
  EngineOptions options;
  options.threads = 1;
  options.law = model->law;
  options.user_effects = model->user_effects;
  FORCEGATE_TRY(const auto workspace, prepare(make_campaign(73, softening, 0.002), options));
  return refit_model(*workspace, *model, "mine", 1);
}

constexpr const char* kMemory = "state.M = \"F > M ? 50 * (F - M) : 0\"\n";

TEST(Refit, AParameterThatTheOutputIsProportionalToTakesTheStrength) {
  for (const char* start : {"0.005", "0"}) {  // a start at 0 hides nothing
    const auto made = refit_own(std::string("output = \"k * (M - F) * F\"\nparameter.k = { value = ") + start + ", unit = \"1/N\" }\n" + kMemory);
    ASSERT_TRUE(made) << made.error().to_text();
    const UserEffect& fitted = made->model.user_effects[0];
    EXPECT_EQ(fitted.output, "k * (M - F) * F");
    ASSERT_EQ(fitted.parameters.size(), 1u);
    EXPECT_NEAR(fitted.parameters[0].value, 0.02, 0.001);
    EXPECT_GT(fitted.parameters[0].se, 0.0);
    EXPECT_LT(fitted.parameters[0].se, 0.001);
  }
}

TEST(Refit, WhereNoParameterIsProportionalAShareIsAndStartsAtOne) {
  const auto made = refit_own(std::string("output = \"(M - F) * F^p / 100\"\nparameter.p = { value = 1, min = 0.8, max = 1.2 }\n") + kMemory);
  ASSERT_TRUE(made) << made.error().to_text();
  const UserEffect& fitted = made->model.user_effects[0];
  ASSERT_EQ(fitted.parameters.size(), 2u);
  EXPECT_EQ(fitted.parameters[1].name, "share");
  EXPECT_NEAR(fitted.parameters[1].value, 2.0, 0.3);
  const auto share = std::ranges::find(made->moves, "mine.share", &ParameterMove::name);
  ASSERT_NE(share, made->moves.end());
  EXPECT_EQ(share->before, 1.0);
}

TEST(Refit, OfTwoFactorsOneIsFittedAndTheOtherStays) {
  const auto made = refit_own(std::string("output = \"a * b * (M - F) * F\"\nparameter.a = 0.1\nparameter.b = 0.1\n") + kMemory);
  ASSERT_TRUE(made) << made.error().to_text();
  const std::vector<ModelParameter>& p = made->model.user_effects[0].parameters;
  ASSERT_EQ(p.size(), 2u);
  EXPECT_NEAR(p[0].value * p[1].value, 0.02, 0.001);
  EXPECT_EQ(p[1].value, 0.1);
  EXPECT_EQ(p[1].se, 0.0);
}

TEST(Refit, AnEquationThatAddsNothingToTheLawIsRefusedWithTheReason) {
  const auto line = refit_own("output = \"k * F + 0.1 * k\"\nparameter.k = 0.01\n"), constant = refit_own("output = \"5\"\n"),
             zero = refit_own("output = \"k * x\"\nstate.x = \"x * x * 100\"\nparameter.k = 0.01\n"),
             warm = refit_own("output = \"k * T * F\"\nparameter.k = 0.01\n");
  ASSERT_FALSE(line || constant || zero || warm);
  EXPECT_NE(line.error().text.find("straight line"), std::string::npos) << line.error().to_text();
  EXPECT_NE(constant.error().text.find("straight line"), std::string::npos) << constant.error().to_text();
  EXPECT_NE(zero.error().text.find("gives 0 on every record"), std::string::npos) << zero.error().to_text();
  EXPECT_NE(warm.error().text.find("no temperature"), std::string::npos) << warm.error().to_text();
}

TEST(Refit, AnInputThatStandsStillIsNamed) {
  const auto model = parse_model("[law]\nkind = \"static\"\ngain_N_per_V = 0.5\n[[effect]]\nname = \"mine\"\noutput = \"k * (T - 20)\"\nparameter.k = 0.05\n", "m.toml");
  ASSERT_TRUE(model) << model.error().to_text();
  EngineOptions options;
  options.threads = 1;
  options.law = model->law;
  options.user_effects = model->user_effects;
  Campaign c = make_campaign(75, straight, 0.002);
  for (Record& r : c.records) r.temp_C = 22.5;
  const auto made = refit_campaign(c, options, *model, "mine");
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().text.find("depends on T, which does not move"), std::string::npos) << made.error().to_text();
}

TEST(Refit, WhatBringsNothingIsNotAccepted) {
  EXPECT_FALSE(lowers_error(0.0541, 0.05409));
  EXPECT_TRUE(lowers_error(0.0541, 0.0500));
  const auto model = parse_model("[law]\nkind = \"static\"\ngain_N_per_V = 0.5\n[[effect]]\nname = \"mine\"\noutput = \"0.05 * F^2\"\n", "m.toml");
  ASSERT_TRUE(model) << model.error().to_text();
  EngineOptions options;
  options.threads = 1;
  options.law = model->law;
  options.user_effects = model->user_effects;
  const auto made = refit_campaign(make_campaign(76, straight, 0.002), options, *model, "mine");
  ASSERT_TRUE(made) << made.error().to_text();
  EXPECT_NEAR(made->error_after, made->error_before, 1e-3 * made->error_before);
  EXPECT_FALSE(made->model.history.back().accepted);
}

// A recording of another machine that is the right curve, late by so much.
Campaign late_by(double delay_s) {
  const auto force = [](double t) { return t < 0.0 ? 3.0 : 3.0 + std::sin(1.1 * t) + 0.6 * std::sin(2.7 * t); };
  return recording(50.0, 6000, force,
                   [&](const std::vector<double>& t, const std::vector<double>&) {
                     std::vector<double> U;
                     for (const double at : t) U.push_back(0.1 + 0.5 * force(at - delay_s));
                     return U;
                   },
                   0.002);
}

double value_of(const Model& model, const std::string& shape) {
  for (const ModelEffect& e : model.effects)
    for (const ModelParameter& p : e.shape)
      if (p.name == shape) return p.value;
  return 0.0;
}

TEST(Refit, EndsNoWorseThanTheModelItBeganWith) {
  for (const char* written : {"0.7", "0.65"}) {
    const auto model = parse_model(std::string("[law]\nkind = \"static\"\ngain_N_per_V = 2.0\noffset_N = -0.2\n[[effect]]\nname = \"delay\"\nform = \"shift\"\n"
                                               "shape.delay_s = { value = ") + written + " }\nstrength.c = { value = 1.0, se = 0.001 }\n", "m.toml");
    ASSERT_TRUE(model) << model.error().to_text();
    const auto fitted = refit_campaign(late_by(0.7), options_of(*model), *model, "");
    ASSERT_TRUE(fitted) << fitted.error().to_text();
    EXPECT_NEAR(value_of(fitted->model, "delay_s"), 0.7, 0.005);
    EXPECT_LT(fitted->error_after, 0.003);
  }
}

TEST(Refit, AnEffectWhoseGridEndsTooSoonIsFoundBeyondIt) {
  EngineOptions options;
  options.threads = 1;
  for (const double delay_s : {0.15, 0.25}) {
    const auto added = refit_campaign(late_by(delay_s), options, *library_model("flexiforce"), "delay");
    ASSERT_TRUE(added) << added.error().to_text();
    EXPECT_NEAR(value_of(added->model, "delay_s"), delay_s, 0.005);
  }
}

TEST(Refit, WhyRecordsCannotShowAnEffectIsTheTrueReason) {
  EngineOptions options;
  options.threads = 1;
  const auto why = [&](const char* effect) {
    const auto made = refit_campaign(late_by(0.01), options, *library_model("flexiforce"), effect);
    return made ? std::string() : made.error().text;
  };
  for (const char* effect : {"wear", "slow_recovery"}) EXPECT_NE(why(effect).find("this is one recording"), std::string::npos) << why(effect);
  EXPECT_NE(why("off_axis").find("theta_rad"), std::string::npos) << why("off_axis");
}

// Slow triangles and an output that is late: what goes to and fro with the direction is no offset, although a recording is judged in blocks.
TEST(Refit, TheOffsetOfOneRecordingIsThatOfAllItsBlocks) {
  const auto triangle = [](double t) {
    const double x = std::fmod(t, 40.0) / 20.0;
    return 0.3 + 4.0 * (x < 1.0 ? x : 2.0 - x);
  };
  const auto late = [&](const std::vector<double>& t, const std::vector<double>&) {
    std::vector<double> U;
    for (const double at : t) U.push_back(2.0 * (triangle(std::max(0.0, at - 0.15)) - 0.1));
    return U;
  };
  const auto fitted = refit(recording(100.0, 30000, triangle, late, 0.003), "");
  ASSERT_TRUE(fitted) << fitted.error().to_text();
  EXPECT_NEAR(fitted->model.law.offset_N, 0.1, 0.01);
  EXPECT_LT(fitted->plain_before, 0.09) << "0.06 V by least squares, 0.35 with slow waves that are part of the offset";
}

// Cyclic records of one lowest force do not part a gain from a swing of its own size: a law that has none foretells the ramp that is left out.
TEST(Refit, OneLawForetellsARampFromCyclesOfSeveralFrequencies) {
  Campaign c;
  c.name = "cycles";
  c.bench.reference_resolution_N = 0.002;
  Rng rng(77, "cycles");
  for (int k = 0; k < 4; ++k) {
    Record r;
    const double f_Hz[] = {0.005, 0.3, 1.0, 2.0}, f = f_Hz[k], A = 1.5, Fmin = 0.4;
    r.name = "r" + std::to_string(k);
    r.kind = k == 0 ? "ramp" : "sine";
    r.dynamic = k > 0;
    r.start_s = 9000.0 * k;
    TimeBase clock;
    std::vector<double> F, U;
    for (int i = 0; i < (k == 0 ? 20000 : 60000); ++i) {
      const double t = i / 100.0, x = std::fmod(t * 0.01, 1.0);
      const double force = k == 0 ? 0.2 + 4.3 * (1.0 - std::abs(2.0 * x - 1.0)) : Fmin + A * (1.0 - std::cos(2.0 * std::numbers::pi * f * t));
      const double b = 0.0019 * f + 0.0056, q = 1.0 / (1.0 + 1.377 * A * A), D = k == 0 ? 1.0 : (std::exp(-b * t) + q) / (1.0 + q);
      clock.t_s.push_back(t);
      F.push_back(force + 0.005 * rng.normal());
      U.push_back(2.0 * (Fmin + D * (force - Fmin) - 0.1) + 0.003 * rng.normal());
    }
    r.trace.time_bases.push_back(clock);
    r.trace.channels.push_back({"F_ref", "N", "force", 0, F, {}});
    r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
    c.records.push_back(std::move(r));
  }
  const auto fitted = refit(std::move(c), "");
  ASSERT_TRUE(fitted) << fitted.error().to_text();
  EXPECT_LT(fitted->plain_before, 0.015);
}

// One recording without a decay: the columns of the bank are pairs of the same, none of them is sure, and no firmware undoes it.
TEST(Refit, OfABentCurveTakesALawAndNotTheBank) {
  const Campaign bent = recording(
      50.0, 15000, [](double t) { return 2.5 + std::sin(0.628 * t) + 0.7 * std::sin(2.32 * t) + 0.3 * std::sin(6.9 * t); },
      [](const std::vector<double>&, const std::vector<double>& x) {
        std::vector<double> y;
        for (const double f : x) y.push_back(0.5 * f + 0.1 + 0.03 * (f - 2.5) * (f - 2.5));
        return y;
      },
      0.003);
  const auto added = refit(bent, "static_nonlinearity");
  ASSERT_TRUE(added) << added.error().to_text();
  ASSERT_EQ(added->model.effects.size(), 1U);
  const EffectKind* kind = EffectRegistry::instance().find("static_nonlinearity");
  EXPECT_FALSE(soaks_up(*kind, *find_form(*kind, added->model.effects.front().form))) << added->model.effects.front().form;
  EXPECT_LT(added->error_after, 0.15 * added->error_before);
  EXPECT_LT(added->error_after, 1.1 * added->floor);
}

}  // namespace
}  // namespace forcegate::diagnose
