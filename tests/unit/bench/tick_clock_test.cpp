#include <gtest/gtest.h>
#include <sched.h>

#include "hil/rig/tick_clock.h"

namespace forcegate {
namespace {

TEST(TickHistogram, CountsHowLateTheTicksWere) {
  TickHistogram h;
  for (int i = 0; i < 97; ++i) h.add(50e-6);
  h.add(-1.0);  // too early is not late
  h.add(2e-3);
  h.add(80e-3);
  EXPECT_EQ(h.ticks(), 100U);
  EXPECT_DOUBLE_EQ(h.share_over_1ms(), 0.02);
  EXPECT_DOUBLE_EQ(h.worst_s(), 80e-3);
  EXPECT_EQ(h.to_text(), "100 ticks, 98.00 % below 0.1 ms, 1.00 % below 3 ms, 1.00 % later; latest 80.00 ms");
  h.clear();
  EXPECT_EQ(h.ticks(), 0U);
  EXPECT_EQ(h.share_over_1ms(), 0.0);
}

TEST(RealTime, IsGivenBackAndSaysWhatItGot) {
  RealTime r;
  r.request();
  if (r.granted()) {
    EXPECT_EQ(sched_getscheduler(0) & ~SCHED_RESET_ON_FORK, SCHED_FIFO);
  } else {
    EXPECT_NE(r.text().find("warning"), std::string::npos) << r.text();
  }
  r.release();
  EXPECT_EQ(sched_getscheduler(0) & ~SCHED_RESET_ON_FORK, SCHED_OTHER);
}

}  // namespace
}  // namespace forcegate
