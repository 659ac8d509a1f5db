// What is printed of a probability never stands on the other side of a claim than the probability.

#include <gtest/gtest.h>

#include "hil/diagnose/diagnosis.h"

namespace forcegate {
namespace {

TEST(ProbabilityText, IsNeverRoundedOverTheBorderOfAClaim) {
  EXPECT_EQ(probability_text(0.498), "0.49");
  EXPECT_EQ(probability_text(std::nextafter(kClaim, 0.0)), "0.49");
  EXPECT_EQ(probability_text(kNoClaim), "0.49");
  EXPECT_EQ(probability_text(kClaim), "0.50");
  EXPECT_EQ(probability_text(0.502), "0.50");
  EXPECT_EQ(probability_text(0.484), "0.48");
  EXPECT_EQ(probability_text(0.976), "0.98");
  EXPECT_EQ(probability_text(0.0), "0.00");
}

}  // namespace
}  // namespace forcegate
