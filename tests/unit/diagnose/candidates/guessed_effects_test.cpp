#include "hil/diagnose/answer/guessed_effects.h"
#include "hil/model/model.h"
#include "tests/unit/diagnose/behind_pole.h"
#include "tests/unit/diagnose/made_campaign.h"
#include "tests/unit/diagnose/options_of_model.h"

namespace forcegate::diagnose {
namespace {

Sensor lagging_by(double tau_s) {
  return [=](const std::vector<double>& t, const std::vector<double>& F, int k) { return straight(t, behind_pole(t, F, tau_s), k); };
}

const Sensor lagging = lagging_by(0.03);

double conductance(double F, double exponent = 0.75) { return 8.0 * std::pow(std::max(F, 0.0) / 4.6, exponent) + 0.2; }

/// The film lags and its conductance bends.
std::vector<double> bent_behind_lag(const std::vector<double>& t, const std::vector<double>& F, int) {
  std::vector<double> U;
  double y = F.front();
  for (std::size_t i = 0; i < F.size(); ++i) {
    if (i > 0) y += (F[i] - y) * -std::expm1(-(t[i] - t[i - 1]) / 0.06);
    U.push_back(conductance(y));
  }
  return U;
}

/// The conductance bends and a filter lags.
Sensor bent_before_lag_of(double exponent, double tau_s) {
  return [=](const std::vector<double>& t, const std::vector<double>& F, int) {
    std::vector<double> U;
    double y = conductance(F.front(), exponent);
    for (std::size_t i = 0; i < F.size(); ++i) {
      if (i > 0) y += (conductance(F[i], exponent) - y) * -std::expm1(-(t[i] - t[i - 1]) / tau_s);
      U.push_back(y);
    }
    return U;
  };
}

const Sensor bent_before_lag = bent_before_lag_of(0.75, 0.06);

Diagnosis answer_of(const Model& model, Campaign campaign) {
  EngineOptions options = options_of(model);
  options.model_name = model.name;
  auto out = diagnose_campaign(std::move(campaign), options);
  EXPECT_TRUE(out.has_value()) << (out ? "" : out.error().to_text());
  return out ? *out : Diagnosis{};
}

Diagnosis answer_of(const Model& model, const Sensor& sensor) { return answer_of(model, make_campaign(7, sensor)); }

std::vector<std::string> claims_of(const Diagnosis& d) {
  std::vector<std::string> out;
  for (const Finding& f : d.findings)
    if (f.claimed()) out.push_back(f.effect);
  return out;
}

bool has_note(const Diagnosis& d, const std::string& part) {
  return std::ranges::any_of(d.notes, [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

TEST(GuessedEffects, ALagThatTheModelHasIsFittedAndIsNoClaim) {
  EXPECT_EQ(answer(make_campaign(7, lagging)).verdict, DiagnosisVerdict::known) << "the model without it misses it";
  const Diagnosis d = answer_of(*library_model("fsr"), lagging);
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_GT(probability(d, "lag"), 0.4) << told(d);
  EXPECT_LT(probability(d, "lag"), 0.5) << told(d);
  EXPECT_TRUE(std::ranges::find(d.findings, "lag", &Finding::effect)->in_model) << told(d);
  EXPECT_TRUE(has_note(d, "the model's lag was a guess: tau_s = 0.0")) << told(d);
  EXPECT_LT(d.error_after, 1.2 * d.floor) << told(d);
}

// A guess knows as little whether a sensor lags by one pole or by two.
TEST(GuessedEffects, ALagOfTwoPolesIsTheModelsLagToo) {
  const Sensor twice = [](const std::vector<double>& t, const std::vector<double>& F, int k) {
    return straight(t, behind_pole(t, behind_pole(t, F, 0.15), 0.15), k);
  };
  const Diagnosis d = answer_of(*library_model("fsr"), twice);
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_TRUE(has_note(d, "of form two_poles fits these records")) << told(d);
  EXPECT_LT(d.error_after, 1.2 * d.floor) << told(d);
}

// The lag of what the curve adds is no second time constant.
TEST(GuessedEffects, ACurveBesideTheLagLagsToo) {
  for (const Sensor& sensor : {Sensor{bent_behind_lag}, bent_before_lag}) {
    const Diagnosis d = answer_of(*library_model("fsr"), sensor);
    EXPECT_EQ(claims_of(d), std::vector<std::string>{"static_nonlinearity"}) << told(d);
    EXPECT_FALSE(d.residual_unknown) << told(d);
    EXPECT_LT(d.error_after, 1.5 * d.floor) << told(d);
  }
}

// What the curve adds moves with the guess while the guess is moved, or it would take part of the move.
TEST(GuessedEffects, ABentCurveDoesNotMoveTheGuess) {
  const Diagnosis d = answer_of(*library_model("fsr"), bent_before_lag_of(0.62, 0.045));
  const std::string moved = "the model's lag was a guess: tau_s = ";
  const auto note = std::ranges::find_if(d.notes, [&](const std::string& n) { return n.starts_with(moved); });
  ASSERT_NE(note, d.notes.end()) << told(d);
  EXPECT_NEAR(std::stod(note->substr(moved.size())), 0.045, 0.002) << *note;
}

// Cyclic records that do not lose their maxima: neither the bend nor the lag is a decay.
TEST(GuessedEffects, ACurveBesideTheLagIsNoDecay) {
  Campaign campaign = make_campaign(7, bent_before_lag);
  for (Record& r : campaign.records)
    if (r.name == "r1" || r.name == "r4" || r.name == "r5") {
      r.kind = "sine", r.dynamic = true, r.excitation_start_s = 0.0;
      std::vector<double>&F = r.trace.find("F_ref")->value, &U = r.trace.find("U")->value;
      const std::vector<double>& t = r.trace.time_bases.front().t_s;
      const double mean = r.name == "r1" ? 0.8 : r.name == "r4" ? 3.6 : 2.2, swing = r.name == "r5" ? 2.1 : 0.7;
      for (std::size_t i = 0; i < F.size(); ++i) F[i] = mean - swing * std::cos(4.0 * t[i]);
      U = bent_before_lag(t, F, 0);
      for (double& u : U) u = std::round(u / 10.0 * 4096.0) / 4096.0 * 10.0;
    }
  const Diagnosis d = answer_of(*library_model("fsr"), campaign);
  EXPECT_TRUE(has_note(d, "no decay of the maxima is seen")) << told(d);
  EXPECT_EQ(claims_of(d), std::vector<std::string>{"static_nonlinearity"}) << told(d);
}

// What a lag that the model knows does to cyclic records is no decay, and a held-out one may lose what the law of the others does not tell.
TEST(GuessedEffects, AKnownLagIsNoDecayAndHidesNone) {
  constexpr double kTau_s = 0.06, kLoss_per_s = 0.0006;
  Campaign campaign = make_campaign(7, lagging_by(kTau_s));
  for (Record& r : campaign.records) {
    if (r.name != "r1" && r.name != "r2" && r.name != "r6") continue;
    r.kind = "sine", r.dynamic = true, r.excitation_start_s = 0.0;
    std::vector<double>&F = r.trace.find("F_ref")->value, &U = r.trace.find("U")->value;
    const std::vector<double>& t = r.trace.time_bases.front().t_s;
    const double omega = r.name == "r6" ? 14.0 : r.name == "r1" ? 6.0 : 2.0, low = 0.9, swing = r.name == "r6" ? 1.8 : 1.2;
    for (std::size_t i = 0; i < F.size(); ++i) F[i] = low + swing * (1.0 - std::cos(omega * t[i]));
    std::vector<double> felt = behind_pole(t, F, kTau_s);
    for (std::size_t i = 0; i < F.size(); ++i) felt[i] = low + (1.0 - kLoss_per_s * t[i]) * (felt[i] - low);
    U = straight(t, felt, 0);
    for (double& u : U) u = std::round(u / 10.0 * 4096.0) / 4096.0 * 10.0;
  }
  Model model = *library_model("fsr");
  model.effects.front().shape.front().value = kTau_s;
  model.effects.front().shape.front().se = 0.0005;
  model.effects.front().strength.front().se = 0.002;
  const Diagnosis d = answer_of(model, campaign);
  EXPECT_EQ(claims_of(d), std::vector<std::string>{}) << told(d);
  EXPECT_LT(d.error_before, 2.0 * d.floor) << told(d);
}

TEST(GuessedEffects, OneThatTheRecordsDoNotShowIsANote) {
  const Diagnosis d = answer_of(*library_model("fsr"), straight);
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_EQ(probability(d, "lag"), 0.0) << told(d);
  EXPECT_TRUE(has_note(d, "these records do not show it")) << told(d);
  EXPECT_EQ(std::ranges::count_if(d.notes, [](const std::string& note) { return note.starts_with("the model's lag was a guess"); }), 1) << told(d);
}

// Nobody reads of one guess that a value of it fits and that nothing shows it.
TEST(GuessedEffects, OneThatMovedAndIsNotShownHasOneNote) {
  auto w = prepare(make_campaign(7, lagging), options_of(*library_model("fsr")));
  ASSERT_TRUE(w.has_value());
  Diagnosis d;
  d.notes = (*w)->input.notes;
  ASSERT_TRUE(has_note(d, "the model's lag was a guess: tau_s = "));
  std::vector<int> columns;
  for (const Candidate& c : (*w)->output.candidates)
    for (int j = 0; c.is_guess && j < c.count; ++j) columns.push_back(c.first + j);
  tell_guessed_effects(**w, fit_mixed((*w)->output.problem, columns, nullptr), 1e9, d);
  EXPECT_TRUE(has_note(d, "these records do not show it"));
  EXPECT_FALSE(has_note(d, "fits these records"));
}

TEST(GuessedEffects, AShapeThatAFitHasEstimatedStays) {
  Model model = *library_model("fsr");
  model.effects.front().shape.front().se = 0.001;
  const Diagnosis d = answer_of(model, lagging);
  EXPECT_FALSE(has_note(d, "was a guess")) << told(d);
  EXPECT_EQ(probability(d, "lag"), 0.0) << told(d);
}

TEST(GuessedEffects, AnEffectWithoutAShapeThatAFitHasEstimatedIsNone) {
  Model model = *library_model("flexiforce");
  const EffectKind& kind = *EffectRegistry::instance().find("static_nonlinearity");
  const EffectForm& form = *std::ranges::find_if(kind.forms, [](const EffectForm& f) { return f.shape.empty(); });
  model.effects.push_back(model_effect(kind, form, {}, std::vector<Estimate>(form.strength.size(), Estimate{-0.02, 0.001})));
  const auto bent = [](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    for (const double f : F) U.push_back(8.0 * std::pow(f / 4.6, 0.97) + 0.2);
    return U;
  };
  EXPECT_EQ(probability(answer_of(model, bent), "static_nonlinearity"), 0.0);
}

}  // namespace
}  // namespace forcegate::diagnose
