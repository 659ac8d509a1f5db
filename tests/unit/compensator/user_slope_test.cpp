// What is told of an equation that leaves too little of a sudden change of force.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/model/compensator/compensator.h"

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

}  // namespace
}  // namespace forcegate
