// What the header would give is asked before it is written.

#include "hil/app/export/self_check.h"

#include <gtest/gtest.h>

namespace forcegate {
namespace {

CompensatorOptions at(double rate_Hz) {
  CompensatorOptions out;
  out.rate_Hz = rate_Hz;
  return out;
}

Model with(const std::string& effects) {
  const auto model = parse_model("[law]\nspan_N = 4\nlowest_N = 0\ngain_N_per_V = 0.5\noffset_N = 0.06\n" + effects, "m.toml");
  EXPECT_TRUE(model) << model.error().to_text();
  return model.value_or(Model{});
}

std::string dead_zone(const char* form, const char* c, const char* F0_N) {
  return std::string("[[effect]]\nname = \"dead_zone\"\nform = \"") + form + "\"\nshape.F0_N = " + F0_N + "\nstrength.c = { value = " + c + ", min = -9, max = 9 }\n";
}

TEST(SelfCheck, AHeaderOfItsOwnModelPasses) {
  for (const Model& model : {with(""), with(dead_zone("skewed", "0.8", "0.6")), with("[[effect]]\nname = \"creep\"\nform = \"power_law\"\nstrength.k_per_decade = 0.05\n"),
                             with("[[effect]]\nname = \"mine\"\noutput = \"k * x\"\nstate.x = \"(F - x) / tau\"\nparameter.k = 0.1\nparameter.tau = 3\n")}) {
    for (const double rate_Hz : {100.0, 1000.0, 20000.0}) {
      const auto made = make_compensator(model, at(rate_Hz));
      ASSERT_TRUE(made) << made.error().to_text();
      const auto check = self_check(model, *made, rate_Hz);
      ASSERT_TRUE(check) << check.error().to_text();
      EXPECT_TRUE(check->made) << check->why_not;
      EXPECT_LT(check->largest_N, 1e-4);
      EXPECT_EQ(check->high_N, 4.0);
    }
  }
}

TEST(SelfCheck, AHeaderThatDoesNotUndoItsModelIsRefusedWithTheForceAndTheDifference) {
  const Model opened = with(dead_zone("skewed", "0.8", "0.6"));
  const auto straight = make_compensator(with(""), {});
  ASSERT_TRUE(straight);
  const auto check = self_check(opened, *straight, 1000.0);
  ASSERT_FALSE(check);
  EXPECT_EQ(check.error().code, ErrorCode::config);
  EXPECT_NE(check.error().text.find(" N it is 0."), std::string::npos) << check.error().to_text();
  EXPECT_FALSE(check.error().hint.empty());
}

// Smooth swings saw 0.3 mN of it, and records 30 mN.
TEST(SelfCheck, AStateThatIsFasterThanTheSamplesIsSeenAndUndoneAtAFasterRate) {
  const auto model = parse_model("[law]\nspan_N = 2.987\nlowest_N = 0.412\ngain_N_per_V = 0.62\noffset_N = 0.15\nb_scale = 1.2\nq_scale = 0.81\n[[effect]]\nname = \"softening\"\n"
                                 "output = \"k * (M - F) * F\"\nstate.M = \"F > M ? 50 * (F - M) : (F - M) / tau\"\nparameter.k = 0.05\nparameter.tau = 200\n", "m.toml");
  ASSERT_TRUE(model) << model.error().to_text();
  for (const double rate_Hz : {100.0, 1000.0}) {
    const auto made = make_compensator(*model, at(rate_Hz));
    ASSERT_TRUE(made) << made.error().to_text();
    EXPECT_EQ(self_check(*model, *made, rate_Hz).has_value(), rate_Hz > 500.0) << rate_Hz;
  }
}

// The forms fall at different forces; together the output went down between 0.1 and 0.2 N, and a header was written.
TEST(SelfCheck, DeadZonesThatFallTogetherAreNoModelToInvert) {
  const Model fallen = with(dead_zone("skewed", "0.8", "0.6") + dead_zone("closing", "-4.8", "0.06") + dead_zone("spread", "-0.09", "1.2"));
  const auto made = make_compensator(fallen, {});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().where, "dead_zone");
}

// A model of forces from 2 to 5 N was asked from 0 to 3.6 N.
TEST(SelfCheck, AnOutputIsAskedAtTheForcesOfItsModel) {
  const auto from = [](const char* lowest_N, const char* output) {
    const auto model = parse_model(std::string("[law]\nspan_N = 3\nlowest_N = ") + lowest_N + "\ngain_N_per_V = 0.5\noffset_N = 0.06\n[[effect]]\nname = \"mine\"\noutput = \"" + output +
                                       "\"\nparameter.k = 0.11\n",
                                   "m.toml");
    EXPECT_TRUE(model) << model.error().to_text();
    return make_compensator(model.value_or(Model{}), {}).has_value();
  };
  EXPECT_TRUE(from("0", "-k * F * F"));
  EXPECT_FALSE(from("2", "-k * F * F")) << "it falls above 4.5 N";
  EXPECT_FALSE(from("0", "k / (F + 0.01)"));
  EXPECT_TRUE(from("2", "k / (F + 0.01)")) << "it falls below 0.3 N";
}

}  // namespace
}  // namespace forcegate
