#include "hil/trace/static_line.h"

#include <gtest/gtest.h>

namespace forcegate {
namespace {

TEST(StaticLine, finds_the_law_that_the_points_lie_on) {
  StaticLine line;
  for (int i = 0; i < 50; ++i) line.push(0.1 * i, 0.5 * 0.1 * i + 0.15);
  EXPECT_TRUE(line.answers(1e-4));
  EXPECT_NEAR(line.gain_N_per_V(), 0.5, 1e-12);
  EXPECT_NEAR(line.offset_N(), 0.15, 1e-12);
  EXPECT_NEAR(line.residual_N(), 0.0, 1e-6);
}

TEST(StaticLine, its_residual_is_the_scatter_about_the_line) {
  StaticLine line;
  for (int i = 0; i < 1000; ++i) line.push(1.0 + i / 2, 2.0 * (1.0 + i / 2) + (i % 2 == 0 ? 0.1 : -0.1));
  EXPECT_NEAR(line.gain_N_per_V(), 2.0, 1e-9);
  EXPECT_NEAR(line.residual_N(), 0.1, 1e-4);
}

TEST(StaticLine, a_sensor_that_does_not_move_or_falls_has_no_answer) {
  StaticLine none, still, falling;
  EXPECT_FALSE(none.answers(1e-4));
  for (int i = 0; i < 50; ++i) still.push(2.0, 0.1 * i), falling.push(-0.1 * i, 0.1 * i);
  EXPECT_FALSE(still.answers(1e-4));
  EXPECT_FALSE(falling.answers(1e-4));
}

TEST(PairMeans, come_out_when_their_group_is_full) {
  PairMeans means(3);
  EXPECT_FALSE(means.push(1.0, 10.0));
  EXPECT_FALSE(means.push(2.0, 20.0));
  EXPECT_TRUE(means.push(6.0, 30.0));
  EXPECT_DOUBLE_EQ(means.sensor_V(), 3.0);
  EXPECT_DOUBLE_EQ(means.force_N(), 20.0);
  EXPECT_FALSE(means.push(1.0, 1.0));
  EXPECT_DOUBLE_EQ(means.sensor_V(), 3.0);
}

}  // namespace
}  // namespace forcegate
