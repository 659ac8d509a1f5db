// Readings that wait for the board's samples: as many as its silence lasts, at any rate of the reference.

#include "hil/rig/bench/passed_readings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hil/interface/rig.h"

namespace forcegate {
namespace {

constexpr double kStale_s = 0.05, kKeep_s = 0.4;

// One newton a second, in clumps of 10 ms.
void fill(PassedForces& forces, double rate_Hz, double until_s) {
  std::vector<ReferenceReading> clump;
  for (int i = 0; i < until_s * rate_Hz; ++i) {
    const double t_s = i / rate_Hz;
    clump.push_back({t_s, static_cast<float>(t_s), 0});
    if (i % std::max(1, static_cast<int>(0.01 * rate_Hz)) == 0) forces.take(clump), clump.clear();
  }
  forces.take(clump);
}

TEST(PassedForces, OfEveryRateReachBackAsFarAsTheBoardMayBeSilent) {
  for (const double rate_Hz : {200.0, 1000.0, 10000.0}) {
    PassedForces forces;
    forces.begin(kKeep_s);
    fill(forces, rate_Hz, 1.0);
    for (const double t_s : {0.62, 0.7, 0.9}) {
      const ForceAt at = forces.at(t_s, kStale_s);
      EXPECT_NEAR(at.force_N, t_s, 1e-5) << rate_Hz;
      EXPECT_EQ(at.status, 0) << rate_Hz;
      EXPECT_TRUE(at.is_final);
    }
  }
}

TEST(PassedForces, ThatWereDroppedAreNotReplacedByYoungerOnes) {
  PassedForces forces;
  forces.begin(0.25);
  forces.take({{0.0, 0.0F, 0}});
  EXPECT_EQ(forces.at(-0.01, kStale_s).force_N, 0.0F) << "the first of a record stands in for what was before it";
  fill(forces, 1000.0, 1.0);
  const ForceAt at = forces.at(0.73, kStale_s);
  EXPECT_TRUE(std::isnan(at.force_N)) << at.force_N << " N is of later";
  EXPECT_EQ(at.status, kRigReferenceFault);
}

TEST(PassedAngles, ReachBackAsFarAsTheBoardMayBeSilent) {
  PassedAngles angles;
  angles.begin(0.0, 0.0, kKeep_s);
  for (int i = 1; i <= 1000; ++i) angles.take(0.001 * i, 0.002 * i);
  EXPECT_NEAR(angles.at(0.62), 1.24, 1e-9);
  EXPECT_NEAR(angles.at(0.9995), 1.999, 1e-9);
}

}  // namespace
}  // namespace forcegate
