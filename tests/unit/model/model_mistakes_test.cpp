// What a model file may say that no model can be made of, or asked.

#include <gtest/gtest.h>

#include "hil/model/model.h"
#include "synthetic.h"

namespace forcegate {
namespace {

const std::string kLaw = "[law]\nkind = \"static\"\ngain_N_per_V = 0.5\n";

Error mistake(const std::string& text) {
  const auto model = parse_model(text, "m.toml");
  EXPECT_FALSE(model) << text;
  return model ? Error{} : model.error();
}

TEST(ModelMistakes, WhatIsFoundInTheSamplesIsNoPartOfAModel) {
  for (const char* name : {"hum", "dropouts", "outliers", "reference_noise"}) {
    const Error e = mistake(kLaw + "[[effect]]\nname = \"" + name + "\"\n");
    EXPECT_NE(e.text.find(std::string(name) + " is found in the samples"), std::string::npos) << e.to_text();
    EXPECT_EQ(e.hint, "take it out");
  }
  EXPECT_EQ(mistake(kLaw + "[[effect]]\nname = \"lagg\"\n").hint, "did you mean \"lag\"?");
}

TEST(ModelMistakes, ABoundThatIsNoNumberHoldsNothing) {
  for (const char* bound : {"min = nan", "max = nan"}) {
    const Error e = mistake("[law]\nkind = \"static\"\ngain_N_per_V = { value = 0.5, " + std::string(bound) + " }\n");
    EXPECT_NE(e.text.find("lies outside"), std::string::npos) << e.to_text();
  }
}

TEST(ModelMistakes, ANumberInQuotesAndBoundsInTheWrongOrderAreToldAsThat) {
  for (const char* gain : {"\"0.5\"", "{ value = \"0.5\" }"}) {
    const Error e = mistake("[law]\nkind = \"static\"\ngain_N_per_V = " + std::string(gain) + "\n");
    EXPECT_EQ(e.text, "the value of gain_N_per_V is a text, \"0.5\"");
    EXPECT_EQ(e.hint, "write the number without quotes");
  }
  const Error e = mistake("[law]\nkind = \"static\"\ngain_N_per_V = { value = 0.5, min = 1, max = 0.1 }\n");
  EXPECT_NE(e.text.find("the bounds of gain_N_per_V are reversed: min = 1 is above max = 0.1"), std::string::npos) << e.to_text();
}

TEST(ModelMistakes, BoundsOfTheLawHoldForWhatIsWrittenThere) {
  EXPECT_TRUE(parse_model("[law]\ngain_N_per_V = { value = 0.5, min = 0.1, max = 0.9 }\n", "m.toml"));
  EXPECT_NE(mistake("[law]\ngain_N_per_V = { value = 0.5, min = 0.6 }\n").text.find("gain_N_per_V"), std::string::npos);
}

TEST(ModelMistakes, ALawThatIsNoDecayIsNone) {
  const auto text = [](const char* constants) { return "[law]\n" + std::string(constants) + "\n"; };
  const Error grows = mistake(text("b_intercept_per_s = -0.01"));
  EXPECT_EQ(grows.text, "b is -0.01 1/s at 0 Hz: the maxima would grow without end");
  EXPECT_EQ(grows.where, "m.toml:2:21");
  EXPECT_NE(mistake(text("b_slope_s_per_s = -0.001")).text.find("at 25 Hz"), std::string::npos);
  EXPECT_NE(mistake(text("b_slope_s_per_s = 0\nb_intercept_per_s = 0")).text.find("nothing would decay"), std::string::npos);
  const Error turns = mistake(text("q_curvature_per_N2 = -1"));
  EXPECT_NE(turns.text.find("q is -0.19 at a swing of 2.5 N"), std::string::npos) << turns.to_text();
  EXPECT_NE(turns.hint.find("above -0.16 for a span of 5 N"), std::string::npos) << turns.to_text();
  // what a decay may be, and what no record decays by
  for (const char* sound : {"b_slope_s_per_s = 0", "b_intercept_per_s = 0", "b_slope_s_per_s = -0.0001", "q_curvature_per_N2 = -0.1", "span_N = 1\nq_curvature_per_N2 = -1", "kind = \"static\"\nb_intercept_per_s = -1"})
    EXPECT_TRUE(parse_model(text(sound), "m.toml")) << sound;
}

TEST(ModelMistakes, AnErrorOfTheHistoryIsANumberFromZeroOn) {
  for (const char* key : {"error_before", "error_after", "plain_before", "plain_after", "floor"})
    for (const char* value : {"-3", "nan", "inf"}) {
      const Error e = mistake(kLaw + "[[history]]\n" + key + " = " + value + "\n");
      EXPECT_EQ(e.text.find(std::string(key) + " = "), 0u) << e.to_text();
      EXPECT_EQ(e.where.substr(0, 9), "m.toml:5:") << e.to_text();
    }
}

TEST(ModelMistakes, ALongEquationIsNotToldWhole) {
  std::string sum = "k * F";
  for (int i = 0; i < 20000; ++i) sum += "+k*F";
  const auto model = parse_model(kLaw + "[[effect]]\nname = \"mine\"\noutput = \"" + sum + "\"\nparameter.k = 1\n", "m.toml");
  ASSERT_FALSE(model);
  EXPECT_LT(model.error().text.size(), 400u);
  EXPECT_NE(model.error().text.find("(80005 characters)"), std::string::npos) << model.error().text;
}

TEST(ModelMistakes, AnEffectWithoutAValueIsToldByNameAndTime) {
  const auto model = parse_model(kLaw + "[[effect]]\nname = \"lag\"\nshape.tau_s = { value = 0.0, min = 0.0 }\nstrength.c = 0.5\n", "m.toml");
  ASSERT_TRUE(model) << model.error().to_text();
  auto campaign = make_campaign_input(test::campaign([](double, double F) { return 2.0 * F; }));
  ASSERT_TRUE(campaign) << campaign.error().to_text();
  const CampaignInFrame in_frame(model->frame, *campaign);
  const auto U = model_output_V(*model, in_frame, in_frame.input().records.front());
  ASSERT_FALSE(U);
  EXPECT_EQ(U.error().code, ErrorCode::config);
  EXPECT_NE(U.error().text.find("the effect lag (one_pole) gives a value that is not finite"), std::string::npos) << U.error().to_text();
}

}  // namespace
}  // namespace forcegate
