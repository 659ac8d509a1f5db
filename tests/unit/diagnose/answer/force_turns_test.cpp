#include "hil/diagnose/answer/force_turns.h"

#include <gtest/gtest.h>

namespace forcegate::diagnose {
namespace {

TEST(ForceTurns, AreTheExtremesFromWhichTheForceComesBack) {
  const std::vector<double> F{1.0, 3.0, 3.0, 2.5, 2.0, 0.0, 0.4, 4.0};
  const std::vector<ForceTurn> turns = force_turns(F, 0.9);
  ASSERT_EQ(turns.size(), 3u);
  EXPECT_FALSE(turns[0].is_highest);  // where it began
  EXPECT_EQ(turns[0].row, 0u);
  EXPECT_EQ(turns[0].seen_at, 1u);
  EXPECT_TRUE(turns[1].is_highest);
  EXPECT_EQ(turns[1].row, 1u) << "the first of a plateau";
  EXPECT_EQ(turns[1].seen_at, 4u);
  EXPECT_FALSE(turns[2].is_highest);
  EXPECT_EQ(turns[2].row, 5u);
  EXPECT_EQ(turns[2].seen_at, 7u);
}

TEST(ForceTurns, OfAForceThatStandsStillAreNone) { EXPECT_TRUE(force_turns({1.0, 1.2, 0.9, 1.1}, 0.5).empty()); }

}  // namespace
}  // namespace forcegate::diagnose
