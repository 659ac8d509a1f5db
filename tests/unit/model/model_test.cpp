#include "hil/model/model.h"

#include <gtest/gtest.h>

#include <tuple>

#include <algorithm>
#include <cmath>

#include "synthetic.h"

namespace forcegate {
namespace {

TEST(LibraryModels, AreReadAndHoldThePapersNumbers) {
  const auto model = library_model("flexiforce");
  ASSERT_TRUE(model.has_value());
  EXPECT_NEAR(model->law.decay_rate_per_s(0.5), 0.0019 * 0.5 + 0.0056, 1e-15);
  EXPECT_NEAR(model->law.depth_ratio(1.5), 1.0 / (1.0 + 1.377 * 2.25), 1e-15);
  EXPECT_TRUE(library_model("fsr").has_value());
  // the FSR's maxima lose 16 % on average (section III-C)
  const auto fsr = library_model("fsr");
  EXPECT_NEAR(1.0 - decay_factor(1e9, 0.01, fsr->law.depth_ratio(1.2)), 0.16, 0.02);
  EXPECT_FALSE(library_model("nosuch").has_value());
}

TEST(LibraryModels, FollowTheSensorThatALabNames) {
  for (const char* fsr : {"FSR 402", "Interlink 406, new", "fsr-like film (40 mm)", "force sensing resistor no. 3"}) EXPECT_EQ(library_model_of(fsr), "fsr") << fsr;
  for (const char* other : {"", "FlexiForce A201, one specimen", "A201", "Tekscan", "FlexiForce (no FSR)", "load cell"})
    EXPECT_EQ(library_model_of(other), "flexiforce") << other;
}

TEST(DecayFactor, StartsAtOneAndEndsAtTheDepthRatio) {
  EXPECT_EQ(decay_factor(0.0, 0.01, 0.3), 1.0);
  EXPECT_EQ(decay_factor(-5.0, 0.01, 0.3), 1.0);
  EXPECT_NEAR(decay_factor(1e6, 0.01, 0.3), 0.3 / 1.3, 1e-12);
}

TEST(ModelFile, SurvivesWritingAndReading) {
  Model model = *library_model("fsr");
  model.law.gain_N_per_V = 0.4375;
  model.history.push_back({"lag", "C01", 0.02, 0.01, 0.005, 0.1, 0.09, "V", true});
  const auto again = parse_model(write_model(model), "test");
  ASSERT_TRUE(again.has_value()) << again.error().to_text();
  EXPECT_EQ(again->law.gain_N_per_V, 0.4375);
  ASSERT_EQ(again->effects.size(), 1u);
  EXPECT_EQ(again->effects[0].shape[0].value, model.effects[0].shape[0].value);
  ASSERT_EQ(again->history.size(), 1u);
  EXPECT_EQ(again->history[0].error_after, 0.01);
}

TEST(ModelFile, NamesThePlaceOfAMistakeAndGuessesTheEffect) {
  const auto wrong = parse_model("[law]\ngain_N_per_V = 0.5\n[[effect]]\nname = \"hysterisis\"\n", "m.toml");
  ASSERT_FALSE(wrong.has_value());
  EXPECT_NE(wrong.error().where.find("m.toml:3"), std::string::npos) << wrong.error().where;
  EXPECT_NE(wrong.error().hint.find("hysteresis"), std::string::npos);
  EXPECT_FALSE(parse_model("[law\n", "m.toml").has_value());
  EXPECT_FALSE(parse_model("[law]\ngain_N_per_V = { value = 5.0, max = 1.0 }\n", "m.toml").has_value());
}

TEST(ModelFile, AMistakeInAnEquationHasItsLine) {
  const std::string head = "[law]\nkind = \"static\"\n[[effect]]\nname = \"mine\"\n";
  const auto place_of = [&](const std::string& text) {
    const auto model = parse_model(text, "m.toml");
    return model ? std::string("accepted") : model.error().where;
  };
  EXPECT_EQ(place_of(head + "output = \"k * z\"\nparameter.k = 1.0\n"), "m.toml:5:10");
  EXPECT_EQ(place_of(head + "output = \"x\"\nstate.x = \"(F - x\"\n"), "m.toml:6:11");
  EXPECT_EQ(place_of(head + "output = \"F = 5\"\n"), "m.toml:5:10") << "an assignment";
  EXPECT_EQ(place_of(head + "output = \"F^2 + 0,02 * F^3\"\n"), "m.toml:5:10") << "a decimal comma";
  EXPECT_EQ(place_of(head + "output = \"max((F), 0.02 * (F - 1)) + min(F, 2, 3)\"\n"), "accepted");
  EXPECT_EQ(place_of(head + "output = \"k == 5 ? F : (F != 1 && F <= 2 && F >= 0)\"\nparameter.k = 1.0\n"), "accepted");
  EXPECT_EQ(place_of("[law]\ngain_N_per_V = 0\n"), "m.toml:2:16");
  EXPECT_EQ(place_of("[law]\ngain_N_per_V = 1e300\n"), "m.toml:2:16");
  EXPECT_EQ(place_of("format = 2\n[law]\n"), "m.toml:1:10");
  const auto input = make_campaign_input(test::campaign([](double, double F) { return F; }));
  const auto lost_at = [&](const std::string& text) {
    const auto model = parse_model(head + text, "m.toml");
    if (!model) return model.error().to_text();
    const auto added = user_effect_N(model->user_effects[0], input->records[0]);
    return added ? std::string("finite") : added.error().where;
  };
  EXPECT_EQ(lost_at("output = \"1 / (F - F)\"\n"), "m.toml:5:10, record " + input->records[0].name);
  EXPECT_EQ(lost_at("output = \"x\"\nstate.x = \"1 + x * x * 100\"\n"), "m.toml:6:11, record " + input->records[0].name);
}

TEST(UserEffect, APowerWithoutAValueBelowZeroIsToldWithItsCure) {
  const auto hint = [](const std::string& output) {
    const auto model = parse_model("[law]\n[[effect]]\nname = \"mine\"\noutput = \"" + output + "\"\n", "m.toml");
    EXPECT_TRUE(model) << model.error().to_text();
    auto input = make_campaign_input(test::campaign([](double, double F) { return F; }));
    RecordInput& record = input->records[0];
    record.F_N[3] = -0.02;
    record.rate_N_per_s[3] = -0.5;
    const auto added = user_effect_N(model->user_effects[0], record);
    EXPECT_FALSE(added) << output;
    return added ? std::string() : added.error().hint;
  };
  EXPECT_NE(hint("0.1 * F^1.5").find("abs(F)^1.5"), std::string::npos) << hint("0.1 * F^1.5");
  EXPECT_NE(hint("0.1 * dF^1.5").find("abs(dF)^1.5"), std::string::npos) << hint("0.1 * dF^1.5");
  EXPECT_NE(hint("0.1 * (F - 99)^1.5").find("abs(..)^1.5"), std::string::npos) << hint("0.1 * (F - 99)^1.5");
  EXPECT_NE(hint("1 / (F - F)").find("divisions"), std::string::npos);
}

TEST(UserEffect, FollowsItsDifferentialEquation) {
  const auto model = parse_model(
      "[law]\ngain_N_per_V = 0.5\n[[effect]]\nname = \"mine\"\noutput = \"k*x\"\nstate.x = \"(F-x)/tau\"\n"
      "parameter.tau = { value = 20.0, unit = \"s\" }\nparameter.k = { value = 0.1, unit = \"1\" }\n",
      "m.toml");
  ASSERT_TRUE(model.has_value()) << model.error().to_text();
  const auto input = make_campaign_input(test::campaign([](double, double F) { return F; }));
  const RecordInput& hold = input->records[2];
  const auto added = user_effect_N(model->user_effects[0], hold);
  ASSERT_TRUE(added.has_value());
  double x = 0.0;
  for (std::size_t i = 1; i < hold.rows(); ++i) {
    const double dt = hold.t_s[i] - hold.t_s[i - 1], mean = 0.5 * (hold.F_N[i] + hold.F_N[i - 1]);
    x = mean + (x - mean) * std::exp(-dt / 20.0);
    EXPECT_NEAR((*added)[i], 0.1 * x, 1e-4);
  }
}

TEST(UserEffect, ReportsAnEquationThatCannotBeRead) {
  UserEffect effect;
  effect.name = "bad";
  effect.output = "F * (";
  const auto input = make_campaign_input(test::campaign([](double, double F) { return F; }));
  const auto added = user_effect_N(effect, input->records[0]);
  ASSERT_FALSE(added.has_value());
  EXPECT_EQ(added.error().code, ErrorCode::config);
}

TEST(UserEffect, SaysWhichQuantityTheRecordLacksAndWhichStateRunsAway) {
  const auto input = make_campaign_input(test::campaign([](double, double F) { return F; }));
  ASSERT_TRUE(input);
  RecordInput bare = input->records[0];
  bare.theta_rad.clear();
  bare.temp_C.clear();
  const auto refused = [&](const std::string& output, const std::string& derivative) {
    UserEffect effect;
    effect.name = "mine";
    effect.output = output;
    effect.states = {{"x", derivative}};
    const auto added = user_effect_N(effect, bare);
    EXPECT_FALSE(added.has_value()) << output;
    return added ? std::string() : added.error().to_text();
  };
  EXPECT_NE(refused("F * x", "T - x").find("uses T, and the record has no temperature"), std::string::npos);
  EXPECT_NE(refused("sin(2 * th) + x", "0").find("uses th, and the record has no angle"), std::string::npos);
  EXPECT_NE(refused("x", "1 + x * x * 100").find("state x of the effect \"mine\" runs away"), std::string::npos);
  EXPECT_NE(refused("x", "F / (2 - 2)").find("derivative of the state x of the effect \"mine\" has no value"), std::string::npos);
  EXPECT_NE(refused("pow(F, 2) + x", "0").find("x^y"), std::string::npos);
}

TEST(UserEffect, ParametersAndStatesCannotBeCalledAsTheInputs) {
  for (const char* line : {"parameter.F = { value = 0.1 }", "state.dF = \"F\"", "state.k = \"F\"\nparameter.k = 1.0"}) {
    const auto model = parse_model(std::string("[law]\ngain_N_per_V = 0.5\n[[effect]]\nname = \"mine\"\noutput = \"F * F\"\n") + line + "\n", "m.toml");
    ASSERT_FALSE(model.has_value()) << line;
    EXPECT_NE(model.error().text.find("means something else"), std::string::npos) << model.error().to_text();
  }
}

TEST(UserEffect, AParameterThatNoEquationHasIsToldAtItsLine) {
  const std::string head = "[law]\nkind = \"static\"\n[[effect]]\nname = \"mine\"\noutput = \"k * F^2\"\nparameter.k = { value = 0.05 }\n";
  const auto unused = parse_model(head + "parameter.zz = { value = 20 }\n", "m.toml");
  ASSERT_FALSE(unused);
  EXPECT_TRUE(unused.error().where.starts_with("m.toml:7")) << unused.error().where;
  EXPECT_NE(unused.error().text.find("zz"), std::string::npos);
  const auto reserved = parse_model(head + "parameter.T = { value = 20 }\n", "m.toml");
  ASSERT_FALSE(reserved);
  EXPECT_TRUE(reserved.error().where.starts_with("m.toml:7")) << reserved.error().where;
  EXPECT_TRUE(parse_model(head, "m.toml"));
}

TEST(ModelFile, WhatIsNotReadIsAnError) {
  const auto text_of = [](const std::string& law, const std::string& rest = "") {
    const auto model = parse_model("[law]\n" + law + "\n" + rest, "m.toml");
    return model ? std::string("accepted") : model.error().to_text();
  };
  EXPECT_EQ(text_of("kind = \"static\"\ngain_N_per_V = 0.5"), "accepted");
  EXPECT_NE(text_of("kind = \"quadratic\"").find("no law of kind \"quadratic\""), std::string::npos);
  EXPECT_NE(text_of("gian_N_per_V = 0.5").find("did you mean \"gain_N_per_V\"?"), std::string::npos);
  EXPECT_NE(text_of("gain_N_per_V = nan").find("no number"), std::string::npos);
  EXPECT_NE(text_of("gain_N_per_V = { value = 0.5, unit = \"V/N\" }").find("N/V"), std::string::npos);
  EXPECT_NE(text_of("q_scale = -1.0").find("not above 0"), std::string::npos);
  EXPECT_NE(text_of("", "[[effect]]\nname = \"lag\"\nshap.tau_s = 0.1\n").find("did you mean \"shape\"?"), std::string::npos);
  EXPECT_NE(text_of("", "[[effect]]\nname = \"lag\"\nshape.tau = 0.1\n").find("tau_s"), std::string::npos);
  EXPECT_NE(text_of("", "[[effect]]\nname = \"creep\"\noutput = \"F\"\n").find("of its own"), std::string::npos);
  const std::string mine = "[[effect]]\nname = \"mine\"\noutput = \"F*F\"\n";
  EXPECT_NE(text_of("", mine + mine).find("two effects are called \"mine\""), std::string::npos);
}

TEST(ModelFile, AKeyThatIsNotReadIsAnErrorAtEveryLevel) {
  const auto text_of = [](const std::string& text) {
    const auto model = parse_model(text, "m.toml");
    return model ? std::string("accepted") : model.error().to_text();
  };
  const std::string law = "[law]\nkind = \"static\"\n", mine = law + "[[effect]]\nname = \"mine\"\noutput = \"k*x\"\nparameter.k = 1.0\n";
  for (const auto& [text, wanted] : std::initializer_list<std::pair<std::string, std::string>>{
           {law + "[[effects]]\nname = \"creep\"\n", "did you mean \"effect\"?"},
           {law + "[effect]\nname = \"creep\"\n", "write [[effect]]"},
           {law + "[history]\neffect = \"creep\"\n", "write [[history]]"},
           {law + "[[history]]\nerror_bevore = 0.1\n", "did you mean \"error_before\"?"},
           {"span = 3\n" + law, "\"span\" means nothing here"},
           {"law = 5\n", "law is no table"},
           {law + "span_N = -3.0\n", "span_N is no number above 0"},
           {law + "span_N = \"five\"\n", "span_N is no number above 0"},
           {law + "temperature_C = \"warm\"\n", "temperature_C is no number"},
           {mine + "state.x = 0.5\n", "state.x is no equation"},
           {mine + "state = \"x\"\n", "state is no table"},
           {law + "[[effect]]\nname = \"mine\"\noutput = 5.0\n", "output is no equation"},
           {law + "[[effect]]\nname = \"mine\"\noutptu = \"F\"\n", "did you mean \"output\"?"},
           {law + "[[effect]]\nname = \"lag\"\nshape = 0.1\n", "shape is no table"}})
    EXPECT_NE(text_of(text).find(wanted), std::string::npos) << text << text_of(text);
  EXPECT_EQ(text_of(mine + "state.x = \"F - x\"\n"), "accepted");
}

TEST(ModelFile, TheUnitOfAnOutputThatIsNoVoltageGoesWithIt) {
  const auto model = parse_model("output_unit = \"S\"\n[law]\ngain_N_per_V = { value = 2e5, unit = \"N/S\" }\n", "m.toml");
  ASSERT_TRUE(model) << model.error().to_text();
  EXPECT_EQ(model->output_unit, "S");
  const std::string text = write_model(*model);
  EXPECT_NE(text.find("output_unit = \"S\""), std::string::npos) << text;
  EXPECT_NE(text.find("unit = \"N/S\""), std::string::npos) << text;
  EXPECT_EQ(parse_model(text, "again.toml")->output_unit, "S");
  EXPECT_EQ(parse_model("[law]\n", "m.toml")->output_unit, "V");
  EXPECT_EQ(write_model(*parse_model("[law]\n", "m.toml")).find("output_unit"), std::string::npos);
  const auto volts = parse_model("[law]\ngain_N_per_V = { value = 2e5, unit = \"N/S\" }\n", "m.toml");
  ASSERT_FALSE(volts);
  EXPECT_EQ(volts.error().text, "gain_N_per_V is in N/V, not in \"N/S\"");
}

TEST(ModelFile, AnOutputUnitThatNobodyKnowsIsRefused) {
  for (const auto& [unit, hint] : {std::pair{"furlong", "known are V, S"}, {"mV", "write \"V\", and the gain in N/V"}, {"pct", "write \"1\""}, {"", "leave it out"}}) {
    const auto model = parse_model("name = \"m\"\noutput_unit = \"" + std::string(unit) + "\"\n[law]\n", "m.toml");
    ASSERT_FALSE(model) << unit;
    EXPECT_NE(model.error().text.find("output_unit"), std::string::npos) << model.error().to_text();
    EXPECT_NE(model.error().hint.find(hint), std::string::npos) << model.error().to_text();
    EXPECT_TRUE(model.error().where.starts_with("m.toml:2:")) << model.error().to_text();
  }
  for (const char* unit : {"V", "S", "A", "F", "counts", "1", "ohm"}) EXPECT_TRUE(parse_model("output_unit = \"" + std::string(unit) + "\"\n[law]\n", "m.toml")) << unit;
}

TEST(ModelFile, WhatIsNoTomlIsToldWhatAModelFileIs) {
  for (const char* text : {"<html>\n", "[law\n", "{\"format\": 1}\n"}) {
    const auto model = parse_model(text, "m.toml");
    ASSERT_FALSE(model) << text;
    EXPECT_NE(model.error().text.find("not valid TOML, as a model file is"), std::string::npos) << model.error().to_text();
    EXPECT_NE(model.error().hint.find("forcegate fit -o"), std::string::npos) << model.error().to_text();
    EXPECT_TRUE(model.error().where.starts_with("m.toml:1:")) << model.error().to_text();
  }
}

TEST(ModelFile, ValuesInAnotherUnitOrOfAnotherTypeAreErrorsEverywhere) {
  const std::string creep = "[law]\n[[effect]]\nname = \"creep\"\nform = \"power_law\"\n";
  for (const auto& [text, what, where] : {
           std::tuple{creep + "strength.k_per_decade = { value = 0.02, unit = \"V\" }\n", "k_per_decade has no unit, and here it is in \"V\"", "m.toml:5:"},
           std::tuple{std::string("[law]\n[[effect]]\nname = \"lag\"\nshape.tau_s = { value = 3, unit = \"ms\" }\n"), "tau_s is in s, not in \"ms\"", "m.toml:4:"},
           std::tuple{creep + "strength.k_per_decade = { value = 0.02, se = -1 }\n", "the standard error of k_per_decade is -1", "m.toml:5:"},
           std::tuple{std::string("[law]\noffset_N = { value = 0.1, se = \"0.1\" }\n"), "se is no number", "m.toml:2:"},
           std::tuple{std::string("[law]\nb_scale = { value = 1, unit = \"N\" }\n"), "b_scale has no unit", "m.toml:2:"},
           std::tuple{std::string("[law]\n[[history]]\nerror_before = \"a\"\n"), "error_before is no number", "m.toml:3:"},
           std::tuple{std::string("[law]\n[[history]]\naccepted = \"yes\"\n"), "accepted is neither true nor false", "m.toml:3:"},
           std::tuple{std::string("[law]\n[[history]]\ncampaign = 7\n"), "campaign is no text", "m.toml:3:"},
           std::tuple{std::string("name = 7\n[law]\n"), "name is no text", "m.toml:1:"},
       }) {
    const auto model = parse_model(text, "m.toml");
    ASSERT_FALSE(model) << text;
    EXPECT_NE(model.error().text.find(what), std::string::npos) << model.error().to_text();
    EXPECT_TRUE(model.error().where.starts_with(where)) << model.error().to_text();
    EXPECT_FALSE(model.error().hint.empty()) << text;
  }
  const auto none = parse_model("[law]\n[[effect]]\nname = \"creep\"\nshape.p = 0.15\n", "m.toml");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().hint, "the form prony of creep has no shape; forcegate explain creep lists the forms with theirs");
}

TEST(ModelFile, AUnitOfAnEquationThatIsNotThatOfItsQuantitiesIsRefused) {
  const auto with_unit = [](const std::string& tau, const std::string& k) {
    return parse_model("[law]\n[[effect]]\nname = \"mine\"\noutput = \"k * x\"\nstate.x = \"(F - x) / tau\"\nparameter.k = " + k + "\nparameter.tau = " + tau + "\n", "m.toml");
  };
  const auto ms = with_unit("{ value = 20000, unit = \"ms\" }", "0.1");
  ASSERT_FALSE(ms);
  EXPECT_EQ(ms.error().text, "tau is in \"ms\", and equations are written in N, s, degC and rad: nothing is converted");
  EXPECT_TRUE(ms.error().where.starts_with("m.toml:7:")) << ms.error().where;
  EXPECT_EQ(ms.error().hint, "write tau = { value = 20, unit = \"s\" }, and bounds in s too");
  for (const char* unit : {"1/mN", "N/min", "V", "kN*s", "%"}) EXPECT_FALSE(with_unit("20", std::string("{ value = 0.1, unit = \"") + unit + "\" }")) << unit;
  for (const char* unit : {"", "1", "1/N", "N/s", "N s^-2", "1/degC", "N/K", "rad", "Hz"})
    EXPECT_TRUE(with_unit("{ value = 20, unit = \"s\" }", std::string("{ value = 0.1, unit = \"") + unit + "\" }")) << unit;
}

TEST(ModelFile, AnyTextAndAnyFittedValueSurviveWriting) {
  Model model = *library_model("fsr");
  model.name = "q\"x\\y";
  model.history.push_back({"lag", "a \"b\"\n", 0.02, 0.01, 0.005, 0.1, 0.09, "V", true});
  const EffectKind& kind = *EffectRegistry::instance().find("dead_zone");
  const EffectForm& form = *find_form(kind, "hard");
  const std::vector<double> shape(form.shape.size(), 195.0);  // of a cell of 4 kN
  model.effects.push_back(model_effect(kind, form, shape, std::vector<Estimate>(form.strength.size(), Estimate{1.0, 0.1})));
  const auto again = parse_model(write_model(model), "test");
  ASSERT_TRUE(again.has_value()) << again.error().to_text();
  EXPECT_EQ(again->name, model.name);
  EXPECT_EQ(again->history[0].campaign, model.history[0].campaign);
  EXPECT_EQ(again->effects.back().shape[0].value, 195.0);
}

}  // namespace
}  // namespace forcegate
