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

// F = k (preload + e (1 - cos theta)), as the geometry says.
double wheel_force_N(const RigGeometry& g, double theta_rad) {
  return g.spring_N_per_mm * (g.preload_mm + g.eccentricity_mm * (1.0 - std::cos(theta_rad)));
}

TEST(WheelGeometry, angle_and_force_are_inverse_to_each_other_over_the_half_turn) {
  for (int i = 1; i < 1000; ++i) {
    const double theta = std::acos(-1.0) * i / 1000.0;
    EXPECT_NEAR(wheel_angle_rad(geometry(), wheel_force_N(geometry(), theta)), theta, 1e-6);
  }
}

TEST(WheelGeometry, preload_and_twice_the_eccentricity_are_the_ends) {
  EXPECT_NEAR(wheel_angle_rad(geometry(), 0.1), 0.0, 1e-6);
  EXPECT_NEAR(wheel_angle_rad(geometry(), 5.1), std::acos(-1.0), 1e-6);
}

TEST(WheelGeometry, forces_out_of_reach_give_the_ends_of_the_travel) {
  EXPECT_EQ(wheel_angle_rad(geometry(), -3.0), 0.0);
  EXPECT_NEAR(wheel_angle_rad(geometry(), 99.0), std::acos(-1.0), 1e-9);
  EXPECT_EQ(wheel_angle_rad(RigGeometry{}, 2.0), 0.0);  // no eccentricity
}

}  // namespace
}  // namespace forcegate
