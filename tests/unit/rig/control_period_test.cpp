#include "hil/rig/control_period.h"

#include <gtest/gtest.h>

namespace forcegate {
namespace {

TEST(ControlPeriod, IsTheTimeOfItsWholeSamples) {
  for (const double rate_Hz : {100.0, 200.0, 1000.0, 10000.0}) {
    EXPECT_EQ(control_period(rate_Hz).s, kControlPeriod_s) << rate_Hz;
  }
  EXPECT_EQ(control_period(250.0).samples, 3U);
  EXPECT_EQ(control_period(250.0).s, 0.012);
  EXPECT_EQ(control_period(30.0).samples, 1U) << "never none";
  EXPECT_EQ(control_period(30.0).s, 1.0 / 30.0);
}

}  // namespace
}  // namespace forcegate
