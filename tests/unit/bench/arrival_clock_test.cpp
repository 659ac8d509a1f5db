#include "hil/base/arrival_clock.h"

#include <gtest/gtest.h>

#include <cmath>

namespace forcegate {
namespace {

// Records every 4 ms, read in clumps every 10 ms.
double clump_s(double measured_s) { return std::ceil(measured_s / 0.01 - 1e-9) * 0.01; }

TEST(ArrivalClock, FindsTheInstantOfEveryRecordFromClumps) {
  ArrivalClock clock;
  clock.begin(250.0, 0.5);
  for (int k = 1; k < 1000; ++k) {
    const double measured_s = 0.004 * k, told_s = clock.next(clump_s(measured_s));
    if (k > 10) {
      EXPECT_NEAR(told_s, measured_s, 1e-9);
    }
  }
  EXPECT_EQ(clock.restarts(), 0U);
}

TEST(ArrivalClock, FollowsADeviceWhoseClockIsOff) {
  ArrivalClock clock;
  clock.begin(250.0, 0.5);
  for (int k = 1; k < 20000; ++k) {
    const double measured_s = 0.004 * 1.0005 * k;  // 500 ppm slow
    const double told_s = clock.next(clump_s(measured_s));
    if (k > 200) {
      EXPECT_NEAR(told_s, measured_s, 0.006);
    }
  }
}

TEST(ArrivalClock, DoesNotDateRecordsBehindAGapBeforeItKnowsHowMuchWasLost) {
  ArrivalClock clock;
  clock.begin(250.0, 0.5);
  for (int k = 1; k <= 100; ++k) clock.next(clump_s(0.004 * k));
  // 100 ms of records come late and at once.
  for (int k = 101; k <= 125; ++k) {
    clock.next(0.5);
    EXPECT_FALSE(clock.settled(0.5));
  }
  for (int k = 126; k < 300; ++k) {
    const double arrival_s = clump_s(0.004 * k), told_s = clock.next(arrival_s);
    if (clock.settled(arrival_s)) {
      EXPECT_NEAR(told_s, 0.004 * k, 0.0021);
    }
  }
  EXPECT_TRUE(clock.settled(1.0));
}

}  // namespace
}  // namespace forcegate
