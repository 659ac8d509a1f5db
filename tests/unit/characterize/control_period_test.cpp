#include <gtest/gtest.h>

#include "hil/characterize/bench.h"
#include "tests/support/following_lag.h"

namespace forcegate::characterize {
namespace {

TEST(ControlPeriodOfTheStudy, IsThatOfTheRigsSamples) {
  const auto stimulus = make_stimulus(sine(0.5, 1.0, 2.0, 30.0));
  ASSERT_TRUE(stimulus);
  for (const double rate_Hz : {1000.0, 250.0, 130.0}) {
    testing::FakeRig rig;
    rig.change_info().rate_Hz = rate_Hz;
    const testing::FollowingLag lag(rig, **stimulus);
    BenchProgress progress;
    Bench bench(rig, {}, progress);
    (void)bench.play(**stimulus, {});
    ASSERT_EQ(bench.samples(), static_cast<std::uint64_t>(30.0 * rate_Hz));
    EXPECT_NEAR(lag.s(), 0.008, 0.001) << rate_Hz;
  }
}

}  // namespace
}  // namespace forcegate::characterize
