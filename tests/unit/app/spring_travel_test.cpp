// How far the wheel is turned where the spring is calibrated.

#include <gtest/gtest.h>

#include <cmath>

#include "hil/app/bench/bench_calibrate.h"

namespace forcegate {
namespace {

double force_N(const RigGeometry& g, double theta_rad) {
  return g.spring_N_per_mm * (g.preload_mm + g.eccentricity_mm * (1.0 - std::cos(theta_rad)));
}

TEST(SpringTravel, StaysBelowTheForceLimitWithThePreload) {
  RigGeometry g;
  g.spring_N_per_mm = 0.25;
  g.eccentricity_mm = 10.0;
  g.theta_max_rad = 3.0;
  for (const double preload_mm : {0.0, 2.0, 8.0}) {
    g.preload_mm = preload_mm;
    const double top_N = force_N(g, spring_top_rad(g, 3.0));
    EXPECT_LE(top_N, 0.95 * 3.0 + 1e-9) << preload_mm;
    EXPECT_GE(top_N, 0.85 * 3.0) << preload_mm;
  }
  g.preload_mm = 2.0;
  EXPECT_NEAR(spring_top_rad(g, 100.0), std::acos(1.0 - 2.0 * 0.95), 1e-9) << "where no force limits it, the travel does";
  g.preload_mm = 12.0;
  EXPECT_EQ(spring_top_rad(g, 3.0), 0.0) << "the preload is the limit";
}

}  // namespace
}  // namespace forcegate
