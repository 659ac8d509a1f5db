// One law for all records, as a firmware has it.

#include "hil/diagnose/refit/one_law.h"

#include "hil/model/model.h"
#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

Model model_of(const std::string& effects) {
  const auto model = parse_model("[law]\nkind = \"static\"\ngain_N_per_V = 0.5\noffset_N = -0.1\n" + effects, "m.toml");
  EXPECT_TRUE(model) << model.error().to_text();
  return *model;
}

std::vector<double> bent(const std::vector<double>&, const std::vector<double>& F, int) {
  std::vector<double> U;
  for (const double f : F) U.push_back(2.0 * (f - 0.04 * f * f) + 0.2);
  return U;
}

TEST(OneLaw, AnEquationOfTheUsersOwnIsAnEffectLikeAnyOther) {
  const auto fit = fit_one_law(make_campaign(81, bent, 0.002), model_of("[[effect]]\nname = \"mine\"\noutput = \"k * F * F\"\nparameter.k = { value = -0.03, se = 0.01 }\n"));
  ASSERT_TRUE(fit) << fit.error().to_text();
  EXPECT_LT(fit->left_out_V, 0.5 * fit->law_left_out_V);
  ASSERT_EQ(fit->model.user_effects.size(), 1u);
  EXPECT_NEAR(fit->model.user_effects[0].parameters[0].value, -0.04, 0.002);
  for (const OneLawFit::Item& item : fit->records) EXPECT_NE(item.law_V, item.model_V) << item.record;
  const auto none = fit_one_law(make_campaign(82, straight, 0.002), model_of("[[effect]]\nname = \"mine\"\noutput = \"k * dF\"\nparameter.k = 0.01\n"));
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().text.find("do not lower"), std::string::npos) << none.error().to_text();
}

// One pole of 40 ms.
std::vector<double> late(const std::vector<double>&, const std::vector<double>& F, int) {
  std::vector<double> U;
  double y = F.front();
  for (const double f : F) {
    y += (f - y) * (1.0 - std::exp(-0.005 / 0.04));
    U.push_back(2.0 * y + 0.2);
  }
  return U;
}

TEST(OneLaw, OfTheFormsThatCanBeUsedTheBestIsTakenAndItsCostIsTold) {
  const Model lag = model_of("[[effect]]\nname = \"lag\"\nform = \"one_pole\"\n");
  const auto form_of = [](const Result<OneLawFit>& fit) { return fit ? fit->model.effects[0].form : fit.error().to_text(); };
  const auto any = fit_one_law(make_campaign(83, late, 0.002), lag);
  EXPECT_EQ(form_of(any), "one_pole");
  EXPECT_TRUE(any->notes.empty());
  const auto other = fit_one_law(make_campaign(83, late, 0.002), lag, [](const Model& m) { return m.effects[0].form != "one_pole"; });
  ASSERT_TRUE(other) << other.error().to_text();
  EXPECT_NE(form_of(other), "one_pole");
  ASSERT_EQ(other->notes.size(), 1u);
  EXPECT_NE(other->notes[0].find("one_pole predicts best"), std::string::npos) << other->notes[0];
  // where none can be used the best one is what the refusal should name
  EXPECT_EQ(form_of(fit_one_law(make_campaign(83, late, 0.002), lag, [](const Model&) { return false; })), "one_pole");
}

// Nobody wrote down that the force cycles, and nothing decays.
TEST(OneLaw, ADecayThatNoRecordShowsIsNotInIt) {
  Campaign c;
  for (const double f_Hz : {0.2, 0.5, 1.0}) {
    Campaign one = recording(50.0, 12000, [&](double t) { return 2.0 - 1.5 * std::cos(2.0 * 3.14159265358979 * f_Hz * t); },
                             [](const std::vector<double>&, const std::vector<double>& F) {
                               std::vector<double> U;
                               for (const double f : F) U.push_back(2.0 * f + 0.2);
                               return U;
                             }, 0.003);
    one.records.front().name += std::to_string(f_Hz);
    c.records.push_back(std::move(one.records.front()));
  }
  const auto fit = fit_one_law(std::move(c), *library_model("flexiforce"));
  ASSERT_TRUE(fit) << fit.error().to_text();
  EXPECT_FALSE(fit->model.law.decays);
  EXPECT_NEAR(fit->model.law.gain_N_per_V, 0.5, 1e-3);
  EXPECT_LT(fit->left_out_V, 0.004);
}

// Eight records whose decay rates scatter by 10 %: what is known of the mean is what the others would make of it, not what the start said.
TEST(OneLaw, TheDecayIsAsUncertainAsTheRecordsDiffer) {
  constexpr int kRecords = 8;
  constexpr double kScatter = 0.1, kScale = 0.8;
  Rng rng(85, "rates");
  std::vector<double> log_b;
  Campaign c;
  for (int k = 0; k < kRecords; ++k) {
    const double f_Hz = 0.5 + 0.25 * k;
    log_b.push_back(kScatter * rng.normal());
    const double b = kScale * std::exp(log_b.back()) * (0.0019 * f_Hz + 0.0056), q = 1.0 / (1.0 + 1.377 * 1.5 * 1.5);
    Campaign one = recording(50.0, 30000, [&](double t) { return 1.7 - 1.5 * std::cos(2.0 * 3.14159265358979 * f_Hz * t); },
                             [&](const std::vector<double>& t, const std::vector<double>& F) {
                               std::vector<double> U;
                               for (std::size_t i = 0; i < F.size(); ++i) U.push_back(2.0 * (0.2 + (std::exp(-b * t[i]) + q) / (1.0 + q) * (F[i] - 0.2)) + 0.2);
                               return U;
                             }, 0.003);
    one.records.front().name += std::to_string(k);
    one.records.front().dynamic = true;
    one.records.front().excitation_start_s = 0.0;
    c.records.push_back(std::move(one.records.front()));
  }
  double mean = 0.0, square = 0.0;
  for (const double x : log_b) mean += x / kRecords;
  for (const double x : log_b) square += (x - mean) * (x - mean) / (kRecords - 1);
  Model start = *library_model("flexiforce");
  start.se_b_scale = 7.0;
  const auto fit = fit_one_law(std::move(c), start);
  ASSERT_TRUE(fit) << fit.error().to_text();
  ASSERT_TRUE(fit->model.law.decays);
  const double expected = std::sqrt(square / kRecords);
  EXPECT_NEAR(std::log(fit->model.law.b_scale / kScale), mean, 2.0 * expected);
  EXPECT_NEAR(fit->model.se_b_scale / fit->model.law.b_scale, expected, 0.6 * expected);
  EXPECT_LT(fit->model.se_q_scale / fit->model.law.q_scale, 0.1);
}

// Opens over 0.4 N, as a refit may write it: in two forms beside each other.
std::vector<double> opening(const std::vector<double>&, const std::vector<double>& F, int) {
  std::vector<double> U;
  for (const double f : F) U.push_back(2.0 * (f + 0.8 * 0.4 * std::expm1(-std::max(f, 0.0) / 0.4)) + 0.2);
  return U;
}

TEST(OneLaw, TheFormsOfOneEffectAreUndoneAsOne) {
  const Model start = model_of("[[effect]]\nname = \"dead_zone\"\nform = \"distributed\"\n[[effect]]\nname = \"dead_zone\"\nform = \"closing\"\n");
  const auto fit = fit_one_law(make_campaign(87, opening, 0.002), start, [](const Model& m) { return m.effects.back().form != "distributed"; });
  ASSERT_TRUE(fit) << fit.error().to_text();
  EXPECT_EQ(fit->model.effects.size(), 1u);
  EXPECT_LT(fit->left_out_V, 0.5 * fit->law_left_out_V);
}

TEST(OneLaw, AFormThatCanBeUsedWithOtherParametersIsNotSaidToBeUnusable) {
  const auto fit = fit_one_law(make_campaign(83, late, 0.002), model_of("[[effect]]\nname = \"lag\"\nform = \"one_pole\"\n"),
                               [](const Model& m) { return m.effects[0].form == "one_pole" && m.effects[0].shape[0].value > 0.06; });
  ASSERT_TRUE(fit) << fit.error().to_text();
  ASSERT_EQ(fit->notes.size(), 1u);
  EXPECT_NE(fit->notes[0].find("one_pole predicts best with parameters with which it cannot be undone; with others it can"), std::string::npos) << fit->notes[0];
}

TEST(OneLaw, IsFittedToTheSamplesThatADiagnosisWouldUse) {
  const Model law = model_of("");
  const auto clean = fit_one_law(make_campaign(84, straight, 0.002), law);
  ASSERT_TRUE(clean) << clean.error().to_text();
  Campaign spikes = make_campaign(84, straight, 0.002), lost = spikes;
  Rng rng(84, "spikes");
  for (std::size_t k = 0; k < spikes.records.size(); ++k) {
    auto& U = spikes.records[k].trace.channels[1].value;
    for (double& u : U)
      if (rng.uniform() < 0.004) u = 9.9;
    auto& V = lost.records[k].trace.channels[1].value;
    for (std::size_t i = 2000; i < V.size(); i += 3000) std::fill_n(V.begin() + static_cast<std::ptrdiff_t>(i), std::min<std::size_t>(150, V.size() - i), 0.001);
  }
  for (const Campaign& c : {spikes, lost}) {
    const auto fit = fit_one_law(c, law);
    ASSERT_TRUE(fit) << fit.error().to_text();
    EXPECT_NEAR(fit->model.law.gain_N_per_V, clean->model.law.gain_N_per_V, 2e-4);
    EXPECT_LT(fit->left_out_V, 1.5 * clean->left_out_V);
  }
}

TEST(OneLaw, TheModelKnowsTheCampaignThatItsEffectsWereFittedOn) {
  Campaign c = make_campaign(85, straight, 0.002);
  for (std::size_t k = 0; k < c.records.size(); ++k) c.records[k].temp_C = 20.0 + static_cast<double>(k);
  const auto fit = fit_one_law(c, model_of(""));
  ASSERT_TRUE(fit) << fit.error().to_text();
  EXPECT_NEAR(fit->model.frame.temperature_C, 23.5, 0.01);
  EXPECT_NEAR(fit->model.frame.span_N, 4.2, 0.1);
}

// A firmware is switched on where a record begins: what the film kept from the record before is no part of its law, and the order of the
// records is none.
TEST(OneLaw, WhatTheFilmKeptFromTheRecordBeforeIsNoPartOfIt) {
  double wide = 0.0;
  const Sensor keeps = [&](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    for (const double f : F) {
      wide = std::clamp(wide, f - 0.8, f + 0.8);
      U.push_back(2.0 * (f + 0.15 * (wide - f)) + 0.2);
    }
    return U;
  };
  const Campaign recorded = make_campaign(88, keeps, 0.002);
  Campaign turned = recorded;
  std::ranges::reverse(turned.records);
  for (std::size_t k = 0; k < turned.records.size(); ++k) turned.records[k].start_s = recorded.records[k].start_s;
  const Model loop = model_of("[[effect]]\nname = \"hysteresis\"\nform = \"play_bank\"\n");
  const auto a = fit_one_law(recorded, loop), b = fit_one_law(turned, loop);
  ASSERT_TRUE(a) << a.error().to_text();
  ASSERT_TRUE(b) << b.error().to_text();
  EXPECT_NEAR(a->left_out_V, b->left_out_V, 1e-9);
  EXPECT_NEAR(a->model.law.gain_N_per_V, b->model.law.gain_N_per_V, 1e-9);
  EXPECT_LT(a->left_out_V, 0.8 * a->law_left_out_V);
}

TEST(OneLaw, OneRecordingIsNoCampaign) {
  Campaign c = make_campaign(86, straight, 0.002);
  c.records.resize(1);
  const auto fit = fit_one_law(std::move(c), model_of(""));
  ASSERT_FALSE(fit);
  EXPECT_NE(fit.error().text.find("at least three"), std::string::npos) << fit.error().to_text();
}

}  // namespace
}  // namespace forcegate::diagnose
