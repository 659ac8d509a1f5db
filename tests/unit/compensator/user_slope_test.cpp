// What is told of an equation that leaves too little of a sudden change of force.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/model/compensator/compensator.h"
#include "hil/model/model_toml.h"

namespace forcegate {
namespace {

using ::testing::HasSubstr;

std::string refusal_of_lag(double share) {
  Model m;
  m.name = "tested";
  m.frame.span_N = 4.0;
  m.law.gain_N_per_V = 0.5;
  m.user_effects.push_back({"mylag", {{"k", "1", share}, {"tau", "s", 0.148}}, {{"x", "(F - x) / tau"}}, "k * (x - F)"});
  const auto made = make_compensator(m, {});
  return made ? "" : made.error().text;
}

TEST(UserSlope, IsToldAsItWasFoundWithoutTheMarginThatDecides) {
  EXPECT_THAT(refusal_of_lag(0.945), HasSubstr("it leaves 0.055 of a sudden change of force in the output, and"));
  EXPECT_THAT(refusal_of_lag(0.85), HasSubstr("it leaves 0.15 of a sudden change of force in the output where that was tried, less than a tenth for certain, and"));
  EXPECT_EQ(refusal_of_lag(0.5), "");
}

// A play was told as a lag, and the form that a dead zone was sent to is refused as well.
TEST(UserSlope, WhatElseToDoIsOfTheEffectAndTheRateIsTold) {
  const auto refused = [](const std::string& effect, double rate_Hz) {
    const auto m = parse_model("[law]\nspan_N = 4\nlowest_N = 0\ngain_N_per_V = 0.5\noffset_N = 0.06\n[[effect]]\n" + effect, "m.toml");
    EXPECT_TRUE(m) << m.error().to_text();
    CompensatorOptions options;
    options.rate_Hz = rate_Hz;
    const auto made = make_compensator(m.value_or(Model{}), options);
    return made ? Error{} : made.error();
  };
  const Error play = refused("name = \"hysteresis\"\nform = \"play_bank\"\nshape.kept = 1\nstrength.w1 = 0.5\nstrength.w2 = 0.7\n", 1000.0);
  EXPECT_THAT(play.text, HasSubstr("its inverse at 1000 Hz would amplify"));
  EXPECT_THAT(play.hint, HasSubstr("accept the loop"));
  const Error lag = refused("name = \"lag\"\nshape.tau_s = 0.5\nstrength.c = 1\n", 100.0);
  EXPECT_THAT(lag.text, HasSubstr("its inverse at 100 Hz would amplify"));
  EXPECT_THAT(lag.hint, HasSubstr("accept the lag"));
  const Error closed = refused("name = \"dead_zone\"\nform = \"hard\"\nshape.F0_N = 0.6\nstrength.c = 1\n", 1000.0);
  EXPECT_THAT(closed.hint, ::testing::Not(HasSubstr("distributed")));
}

}  // namespace
}  // namespace forcegate
