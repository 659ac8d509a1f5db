#include "hil/rig/controllers/wheel_geometry.h"

#include <gtest/gtest.h>

#include <cmath>

namespace forcegate {
namespace {

RigGeometry geometry() {
  RigGeometry g;
  g.eccentricity_mm = 10.0;
  g.preload_mm = 0.4;
  return g;
}

TEST(WheelGeometry, angle_and_force_are_inverse_to_each_other_over_the_half_turn) {
  for (int i = 1; i < 1000; ++i) {
    const double theta = std::acos(-1.0) * i / 1000.0;
    EXPECT_NEAR(wheel_angle_rad(geometry(), wheel_force_N(geometry(), theta)), theta, 1e-6);
  }
}

TEST(WheelGeometry, preload_and_twice_the_eccentricity_are_the_ends) {
  EXPECT_NEAR(wheel_force_N(geometry(), 0.0), 0.1, 1e-12);
  EXPECT_NEAR(wheel_force_N(geometry(), std::acos(-1.0)), 5.1, 1e-12);
}

TEST(WheelGeometry, forces_out_of_reach_give_the_ends_of_the_travel) {
  EXPECT_EQ(wheel_angle_rad(geometry(), -3.0), 0.0);
  EXPECT_NEAR(wheel_angle_rad(geometry(), 99.0), std::acos(-1.0), 1e-9);
  EXPECT_EQ(wheel_angle_rad(RigGeometry{}, 2.0), 0.0);  // no eccentricity
}

}  // namespace
}  // namespace forcegate
