// Exported compensators are built with the host's compiler and replayed: the model answers to forces, the C inverts.

#include "hil/model/compensator/compensator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hil/app/export/calibration_map.h"
#include "hil/app/export/compensator_check.h"
#include "hil/app/files/find_plan.h"
#include "tests/unit/compensator/declare_cycled.h"

namespace forcegate {
namespace {

ModelEffect effect(const std::string& name, const std::string& form, const std::vector<double>& strength,
                   const std::vector<double>& shape = {}) {
  const EffectKind* kind = EffectRegistry::instance().find(name);
  EXPECT_NE(kind, nullptr) << name;
  const EffectForm* found = find_form(*kind, form);
  EXPECT_NE(found, nullptr) << form;
  ModelEffect out{name, form, {}, {}};
  for (std::size_t k = 0; k < found->shape.size(); ++k)
    out.shape.push_back({found->shape[k].name, found->shape[k].unit,
                         k < shape.size() ? shape[k] : found->shape[k].neutral, 0, -1e9, 1e9, 0});
  for (std::size_t k = 0; k < found->strength.size(); ++k)
    out.strength.push_back({found->strength[k].name, found->strength[k].unit,
                            k < strength.size() ? strength[k] : 0.0, 0, -1e9, 1e9, 0});
  return out;
}

Model model_with(std::vector<ModelEffect> effects) {
  Model m;
  m.name = "tested";
  m.frame.span_N = 4.0;
  m.law.gain_N_per_V = 0.5;
  m.law.offset_N = 0.12;
  m.effects = std::move(effects);
  return m;
}

Record record_of(const std::string& name, bool dynamic, double seconds, double (*force)(double)) {
  Record r;
  r.name = name;
  r.dynamic = false;
  if (dynamic) declare_cycled(r);
  TimeBase clock;
  clock.nominal_rate_Hz = 200.0;
  Channel F{"F_ref", "N", "force", 0, {}, {}}, U{"U", "V", "voltage", 0, {}, {}},
      T{"temp", "degC", "temperature", 0, {}, {}};
  for (int i = 0; i < static_cast<int>(200.0 * seconds); ++i) {
    const double t = i / 200.0;
    clock.t_s.push_back(t);
    F.value.push_back(force(t));
    U.value.push_back((force(t) - 0.12) / 0.5);
    T.value.push_back(23.0 + 3.0 * std::sin(t / 40.0));
  }
  r.trace.time_bases.push_back(clock);
  r.trace.channels = {F, U, T};
  return r;
}

Campaign campaign() {
  Campaign c;
  c.name = "forces";
  c.bench.adc_bits = 16;
  c.bench.voltage_max_V = 10.0;
  c.records.push_back(record_of("sine", true, 60, [](double t) {
    return t < 2.0 ? 1.1 : 2.15 - 1.05 * std::cos(3.14159265 * (t - 2.0));
  }));
  c.records.push_back(record_of(
      "triangle", false, 40, [](double t) { return 0.2 + 3.8 * std::fabs(std::fmod(t / 10.0, 2.0) - 1.0); }));
  c.records.push_back(record_of("minor", false, 40,
                                [](double t) { return 2.0 + std::cos(0.6 * t) + 0.7 * std::cos(2.3 * t); }));
  return c;
}

// Largest difference in LSB; a failure to build is a failure of the test.
double replay_LSB(const Model& model, CompensatorOptions options = {}) {
  double sum = 0.0, n = 0.0;
  for (const Record& r : campaign().records)
    for (double T : r.trace.find("temp")->value) sum += T, n += 1.0;
  options.reference_temperature_C = sum / n;
  const auto made = make_compensator(model, options);
  EXPECT_TRUE(made) << made.error().to_text();
  if (!made) return 1e9;
  const auto check = check_compensator(model, *made, options.rate_Hz, campaign());
  EXPECT_TRUE(check) << check.error().to_text();
  return check ? check->largest_N / check->lsb_N : 1e9;
}

TEST(Compensator, TheLawAloneIsInverted) { EXPECT_LT(replay_LSB(model_with({})), 0.05); }

TEST(Compensator, EveryFormOfHysteresisIsUndone) {
  EXPECT_LT(replay_LSB(model_with({effect("hysteresis", "play_bank", {0.02, 0.03, 0.05, 0.04, 0.03, 0.02})})),
            0.1);
  EXPECT_LT(replay_LSB(model_with({effect("hysteresis", "play_bank_undecayed", {0, 0.03, 0, 0.04})})), 0.1);
  EXPECT_LT(replay_LSB(model_with({effect("hysteresis", "play_bank_curved",
                                          {0.03, 0.04, 0.02, 0, 0, 0, 0.02, 0.01, 0.02, 0.01})})),
            0.1);
  EXPECT_LT(replay_LSB(model_with({effect("hysteresis", "bouc_wen", {0.15}, {0.3})})), 0.1);
}

TEST(Compensator, EveryFormOfCreepIsUndone) {
  const std::vector<double> prony{0.01, 0.01, 0.02, 0.02, 0.03, 0.03, 0.05};
  EXPECT_LT(replay_LSB(model_with({effect("creep", "prony", prony)})), 0.1);
  EXPECT_LT(replay_LSB(model_with({effect("creep", "prony_settled", prony)})), 0.1);
  EXPECT_LT(replay_LSB(model_with({effect("creep", "prony_decayed", prony)})), 0.1);
  EXPECT_LT(replay_LSB(model_with({effect("creep", "power_law", {0.03}, {0.12})})), 0.1);
  EXPECT_LT(replay_LSB(model_with({effect("creep", "power_law_decayed", {0.03}, {0.0})})), 0.1);
  EXPECT_LT(replay_LSB(model_with({effect("creep", "stress_activated", {0.1}, {60.0, 0.5})})), 0.1);
  EXPECT_LT(replay_LSB(model_with({effect("creep", "stress_activated_settled", {0.1}, {60.0, 0.5})})), 0.1);
}

TEST(Compensator, EveryFormOfLagIsUndone) {
  EXPECT_LT(replay_LSB(model_with({effect("lag", "one_pole", {0.6}, {0.05})})), 0.2);
  EXPECT_LT(replay_LSB(model_with({effect("lag", "two_poles", {0.6}, {0.05})})), 0.2);
  EXPECT_LT(replay_LSB(model_with({effect("lag", "diffusive", {0.6}, {0.064})})), 0.2);
  EXPECT_LT(replay_LSB(model_with({effect("lag", "two_speeds", {0.6}, {0.05, 2.5})})), 0.2);
  Model pressed = model_with({effect("lag", "sooner_under_load", {0.6}, {0.05, 0.5})});
  pressed.frame.lowest_N = 0.2;  // of the campaign: the time constant is that at mid force
  EXPECT_LT(replay_LSB(pressed), 0.2);
}

TEST(Compensator, CurvesThermalEffectsAndDeadZonesAreUndone) {
  EXPECT_LT(replay_LSB(model_with({effect("static_nonlinearity", "polynomial", {0.05, -0.03})})), 0.1);
  EXPECT_LT(replay_LSB(model_with({effect("static_nonlinearity", "polynomial_after_decay", {0.05, -0.03})})),
            0.1);
  EXPECT_LT(replay_LSB(model_with({effect("static_nonlinearity", "power_law", {0.1})})), 0.3);
  EXPECT_LT(replay_LSB(model_with({effect("static_nonlinearity", "saturation", {0.2}, {3.0, 0.5})})), 0.3);
  EXPECT_LT(replay_LSB(model_with({effect("thermal", "lagged", {0.003, 0.001}, {60.0, 0.0})})), 0.1);
  EXPECT_LT(replay_LSB(model_with({effect("thermal", "lagged", {0.003, 0.001}, {60.0, 1.0})})), 0.1);
  EXPECT_LT(replay_LSB(model_with({effect("thermal", "activated", {0.003, 0.001}, {15.0, 0.03})})), 0.1);
  EXPECT_LT(replay_LSB(model_with({effect("thermal", "activated", {0.003, 0.001}, {0.0, -0.05})})), 0.1);
  EXPECT_LT(replay_LSB(model_with({effect("dead_zone", "distributed", {0.5}, {0.2})})), 0.3);
  EXPECT_LT(replay_LSB(model_with({effect("dead_zone", "closing", {0.5}, {0.2})})), 0.3);
  EXPECT_LT(replay_LSB(model_with({effect("dead_zone", "skewed", {0.5}, {0.8})})), 0.3);
  EXPECT_LT(replay_LSB(model_with({effect("dead_zone", "spread", {0.5}, {0.8})})), 0.3);
  EXPECT_LT(replay_LSB(model_with({effect("dead_zone", "long_tailed", {0.5}, {0.8})})), 0.3);
  EXPECT_LT(replay_LSB(model_with({effect("dead_zone", "hard", {0.5}, {0.2})})), 0.3);
}

TEST(Compensator, CurvesThatLagAreUndoneBesideTheLag) {
  const ModelEffect lag = effect("lag", "one_pole", {0.6}, {0.05});
  for (const char* form : {"polynomial_after_lag", "polynomial_before_lag"})
    EXPECT_LT(replay_LSB(model_with({lag, effect("static_nonlinearity", form, {0.05, -0.03}, {0.05})})), 0.3) << form;
  const auto undone_LSB = [&](const std::string& form, double c, double shape) { return replay_LSB(model_with({lag, effect("static_nonlinearity", form, {c}, {0.05, shape})})); };
  for (const char* order : {"_after_lag", "_before_lag"}) EXPECT_LT(std::max(undone_LSB(std::string("power") + order, 0.9, 0.85), undone_LSB(std::string("touch") + order, 0.1, 0.02)), 0.5) << order;
}

// A form that is exported as another one would be found on the user's bench.
TEST(Compensator, EveryFormOfTheLibraryIsUndoneOrRefused) {
  int undone = 0;
  for (const EffectKind& kind : EffectRegistry::instance().all())
    for (const EffectForm& form : kind.forms) {
      const double sign = form.sign == StrengthSign::negative ? -1.0 : 1.0;
      std::vector<double> shape;
      for (const ParameterSpec& p : form.shape) shape.push_back(p.neutral);
      Model model = model_with({effect(kind.name, form.name, std::vector<double>(form.strength.size(), 0.01 * sign), shape)});
      model.frame.temperature_C = 23.0;
      if (const auto made = make_compensator(model, {}); !made) {
        EXPECT_FALSE(made.error().hint.empty()) << kind.name << ", " << form.name;
        continue;
      }
      ++undone;
      EXPECT_LT(replay_LSB(model), 0.5) << kind.name << ", " << form.name;
    }
  EXPECT_GT(undone, 20);
}

TEST(Compensator, EffectsTogetherAreUndone) {
  EXPECT_LT(replay_LSB(model_with({effect("creep", "prony", {0.01, 0.01, 0.02, 0.02}),
                                   effect("hysteresis", "play_bank", {0.02, 0.03, 0.05, 0.04}),
                                   effect("static_nonlinearity", "polynomial", {0.03, -0.02})})),
            0.1);
}

TEST(Compensator, AUsersEquationIsUndone) {
  Model m = model_with({});
  m.user_effects.push_back({"relax",
                            {{"k", "1", 0.08}, {"tau", "s", 12.0}},
                            {{"x", "(F - x) / tau"}},
                            "k * x * (1 + 0.1 * tanh(F - 2))"});
  // causal steps where the model looks half a step ahead: a few LSB at 1 kHz
  EXPECT_LT(replay_LSB(m), 3.0);
  m.user_effects[0].output = "F > 2 ? k * (F - 2)^2 : 0";
  m.user_effects[0].states.clear();
  EXPECT_LT(replay_LSB(m), 0.1);
}

Model with_equation(const std::string& output, double k) {
  Model m = model_with({});
  m.user_effects.push_back({"ratey", {{"k", "s/N", k}}, {}, output});
  return m;
}

TEST(Compensator, AnEquationInTheRateIsUndoneWhereTheOutputGrowsWithTheForce) {
  EXPECT_LT(replay_LSB(with_equation("k * dF * F", 0.03)), 1.0);
  EXPECT_LT(replay_LSB(with_equation("k * dF", 0.03)), 1.0);
  // of second order: a difference over the last sample alone is late by half of one
  const auto made = make_compensator(with_equation("k * dF", 0.03), {});
  ASSERT_TRUE(made);
  EXPECT_NE(made->header.find("1.5f * F"), std::string::npos);
}

// Beside the force of a steady rate there is another one that gives the same output: a slow firmware must not find that.
TEST(Compensator, ASlowFirmwareFindsTheForceOfASteadyRate) {
  Campaign fast;
  fast.records.push_back(record_of("fast", false, 20, [](double t) { return 1.35 + 0.85 * std::sin(4.0 * 3.14159265 * t); }));
  CompensatorOptions options;
  options.rate_Hz = 100.0;
  const Model m = with_equation("k * dF * F", 0.03);
  const auto made = make_compensator(m, options);
  ASSERT_TRUE(made) << made.error().to_text();
  const auto check = check_compensator(m, *made, options.rate_Hz, fast);
  ASSERT_TRUE(check) << check.error().to_text();
  EXPECT_LT(check->largest_N, 1e-4);
}

// |dF| does not tell whether the force rises or falls.
TEST(Compensator, AnEquationThatGivesOneVoltageToTwoForcesIsRefused) {
  for (const auto& [output, k] : std::initializer_list<std::pair<const char*, double>>{
           {"k * abs(dF) * F", 0.03}, {"k * dF", -0.03}, {"k * dF * dF", 0.03}, {"k * F * F", -0.5}, {"k * sign(dF)", -0.2}}) {
    const auto made = make_compensator(with_equation(output, k), {});
    ASSERT_FALSE(made) << output;
    EXPECT_NE(made.error().text.find("ratey"), std::string::npos) << made.error().text;
    EXPECT_NE(made.error().text.find("two forces give one voltage"), std::string::npos) << made.error().text;
    EXPECT_FALSE(made.error().hint.empty());
  }
}

// Plays of both signs, as a joint fit gives them: what is left of a step is what the widest of them leave together.
TEST(Compensator, PlaysOfBothSignsAreJudgedTogether) {
  const ModelEffect anew = effect("hysteresis", "play_bank", {0.70, -0.59, 0.12, 0.16, -0.10, 0.04}, {0.0}),
                    kept = effect("hysteresis", "play_bank", {-0.61, 0.60, 0.13, -0.14, 0.08, -0.03}, {1.0});
  const auto made = make_compensator(model_with({anew, kept}), {});
  ASSERT_TRUE(made) << made.error().to_text();
  EXPECT_EQ(made->id, "hysteresis");
  EXPECT_EQ(made->effects.size(), 1u);
  EXPECT_LT(made->noise_gain, 1.6);
  EXPECT_LT(replay_LSB(model_with({effect("hysteresis", "play_bank", {0.09, 0.01, 0.25, 0.02, -0.02, 0.01})})), 0.1);
}

TEST(Compensator, AHeaderThatDoesNotInvertOrMakesTheErrorLargerIsObjectedTo) {
  CompensatorCheck check;
  check.lsb_N = 1e-4;
  check.plain_rms_N = 0.1;
  check.compensated_rms_N = 0.005;
  check.largest_N = 3e-4;
  EXPECT_TRUE(objections(check).empty());
  check.largest_N = 0.02;
  ASSERT_EQ(objections(check).size(), 1u);
  EXPECT_NE(objections(check)[0].find("2e+02 LSB"), std::string::npos) << objections(check)[0];
  check.compensated_rms_N = 0.3;
  EXPECT_EQ(objections(check).size(), 1u) << "what is left is far larger than the difference";
  check.largest_N = 0.1;
  EXPECT_EQ(objections(check).size(), 2u);
}

TEST(Compensator, WhatIsCutFromALongRecordIsTold) {
  const auto made = make_compensator(model_with({}), {});
  ASSERT_TRUE(made);
  const auto check = check_compensator(model_with({}), *made, 1000.0, campaign(), 45.0);
  ASSERT_TRUE(check) << check.error().to_text();
  EXPECT_NEAR(check->records[0].cut_s, 15.0, 0.1);
  EXPECT_EQ(check->records[1].cut_s, 0.0);
}

TEST(Compensator, WhatAMicrocontrollerCannotUndoIsRefusedByNameWithTheReason) {
  for (const char* name : {"delay", "wear", "hum", "mounting", "slow_recovery"}) {
    const EffectKind* kind = EffectRegistry::instance().find(name);
    ASSERT_NE(kind, nullptr) << name;
    ModelEffect e{name, kind->forms.empty() ? "" : kind->forms[0].name, {}, {}};
    const auto made = make_compensator(model_with({e}), {});
    ASSERT_FALSE(made) << name;
    EXPECT_NE(made.error().text.find(name), std::string::npos) << made.error().text;
    EXPECT_FALSE(made.error().hint.empty());
  }
  const auto lag = make_compensator(model_with({effect("lag", "one_pole", {1.0}, {0.2})}), {});
  ASSERT_FALSE(lag);
  EXPECT_NE(lag.error().text.find("noise"), std::string::npos);
  const auto rig = make_compensator(model_with({ModelEffect{"backlash", "", {}, {}}}), {});
  ASSERT_FALSE(rig);
  EXPECT_NE(rig.error().text.find("must not copy"), std::string::npos) << rig.error().text;
}

TEST(Compensator, AnEquationThatNeedsLibmOrTheWheelIsRefusedWithItsPlace) {
  Model m = model_with({});
  m.user_effects.push_back({"mine", {}, {}, "sin(F)"});
  auto made = make_compensator(m, {});
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().text.find("sin"), std::string::npos);
  m.user_effects[0].output = "0.1 * th";
  made = make_compensator(m, {});
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().text.find("'th'"), std::string::npos);
  EXPECT_NE(made.error().where.find("mine"), std::string::npos);
}

TEST(Compensator, TheHeaderStatesItsCostAndUsesNoLibraryBeyondFixedIntegers) {
  const auto made = make_compensator(model_with({effect("creep", "prony", {0.01, 0.02})}), {});
  ASSERT_TRUE(made);
  EXPECT_NE(made->header.find("floating-point operations"), std::string::npos);
  EXPECT_NE(made->header.find("bytes of\n   state"), std::string::npos);
  EXPECT_EQ(made->header.find("math.h"), std::string::npos);
  EXPECT_EQ(made->header.find("double "), std::string::npos);
  EXPECT_EQ(made->header.find("malloc"), std::string::npos);
  EXPECT_EQ(made->id, "creep");
}

TEST(Compensator, TheHeaderSaysTheRateThatItWasMadeFor) {
  CompensatorOptions options;
  options.rate_Hz = 312.5;
  const auto odd = make_compensator(model_with({}), options), whole = make_compensator(model_with({}), {});
  ASSERT_TRUE(odd && whole);
  EXPECT_NE(odd->header.find("#define FG_COMP_RATE_HZ 312.5f\n"), std::string::npos);
  EXPECT_NE(whole->header.find("#define FG_COMP_RATE_HZ 1000\n"), std::string::npos);
}

TEST(Compensator, AThermalEffectIsZeroWhereTheModelSaysSo) {
  Model m = model_with({effect("thermal", "lagged", {0.003, 0.001}, {0.0, 0.0})});
  EXPECT_FALSE(make_compensator(m, {}));
  m.frame.temperature_C = 31.0;
  const auto made = make_compensator(m, {});
  ASSERT_TRUE(made) << made.error().to_text();
  EXPECT_NE(made->header.find("from 31 degC"), std::string::npos);
  // the campaign that it is replayed on is colder
  const auto check = check_compensator(m, *made, 1000.0, campaign());
  ASSERT_TRUE(check) << check.error().to_text();
  EXPECT_LT(check->largest_N, 0.1 * check->lsb_N);
}

TEST(CalibrationMap, IsThatOfTheModelsOwnLaw) {
  const auto path = find_plan("smoke");
  ASSERT_TRUE(path);
  const auto plan = read_plan(*path);
  ASSERT_TRUE(plan);
  Model m = model_with({});
  m.law.b_slope = 0.004;
  m.law.b_intercept_per_s = 0.008;
  m.law.q_curvature = 0.9;
  const auto map = calibration_map(m, *plan);
  ASSERT_TRUE(map);
  EXPECT_NEAR(map->b[0] + map->b[1], 1.0, 0.02);
  EXPECT_NEAR(map->q[0] + map->q[2], 1.0, 0.02);
  EXPECT_NEAR(map->b[1], 1.0, 0.03);
  EXPECT_NEAR(map->q[2], 1.0, 0.03);
}

TEST(CalibrationMap, AnEquationInTheTemperatureIsCalibratedWhereTheEffectsAreZero) {
  const auto path = find_plan("smoke");
  ASSERT_TRUE(path);
  const auto plan = read_plan(*path);
  ASSERT_TRUE(plan);
  const Model m = with_equation("k * (T - 20) * F", 0.01);
  EXPECT_FALSE(calibration_map(m, *plan));
  const auto warm = calibration_map(m, *plan, 30.0);
  ASSERT_TRUE(warm) << warm.error().to_text();
  EXPECT_NEAR(warm->alpha, 1.0 / 1.1, 1e-6);
  const auto thermal = calibration_map(model_with({effect("thermal", "lagged", {0.003, 0.001}, {60.0, 0.0})}), *plan, 30.0);
  ASSERT_TRUE(thermal);
  EXPECT_NEAR(thermal->alpha, 1.0, 1e-9);
}

// Their bends are taken off a line through the whole campaign's readings, and the campaign is here the one simulated record.
TEST(CalibrationMap, ASimulatedRecordHasItsDecayWhereAnEffectAsksTheWholeCampaign) {
  const auto path = find_plan("smoke");
  ASSERT_TRUE(path);
  const auto plan = read_plan(*path);
  ASSERT_TRUE(plan);
  for (const auto& [name, form, shape] : {std::tuple{"clipping", "rail", std::vector<double>{0.9}}, std::tuple{"adc_codes", "bit_weights", std::vector<double>{10.0}}}) {
    const auto map = calibration_map(model_with({effect(name, form, {0.0}, shape)}), *plan, 23.0);
    ASSERT_TRUE(map) << name << ": " << map.error().to_text();
    EXPECT_NEAR(map->alpha, 1.0, 1e-6) << name;
  }
}

TEST(CalibrationMap, TakesBackWhatTheSweepsMakeOfCreep) {
  const auto path = find_plan("smoke");
  ASSERT_TRUE(path);
  const auto plan = read_plan(*path);
  ASSERT_TRUE(plan);
  const auto none = calibration_map(model_with({}), *plan);
  ASSERT_TRUE(none);
  EXPECT_NEAR(none->alpha, 1.0, 1e-9);
  EXPECT_NEAR(none->beta_N, 0.0, 1e-9);
  EXPECT_NEAR(none->b[1], 1.0, 0.02);
  EXPECT_NEAR(none->q[2], 1.0, 0.02);
  const auto creep = calibration_map(model_with({effect("creep", "prony", {0.1})}), *plan);
  ASSERT_TRUE(creep);
  EXPECT_NEAR(creep->alpha, 1.0 / 1.1,
              0.01);  // a second is nothing to a sweep: creep of 10 % is a gain of 10 %
  EXPECT_LT(creep->residual_pct, 1.0);
}

}  // namespace
}  // namespace forcegate
