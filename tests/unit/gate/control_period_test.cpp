// At rates that are no multiple of 100 Hz a controller is told the period that it has.

#include <gtest/gtest.h>

#include "hil/gate/play_profile.h"
#include "tests/support/following_lag.h"
#include "tests/unit/gate/runner_bench.h"

namespace forcegate {
namespace {

using testing::Bench;
using testing::FollowingLag;

// `play` makes the record or the profile on the bench.
template <class Play>
void expect_the_lag_of_the_wheel(const Play& play) {
  for (const double rate_Hz : {1000.0, 250.0, 130.0}) {
    Bench s;
    s.rig.change_info().rate_Hz = rate_Hz;
    const auto stimulus = make_stimulus(s.job.planned.stimulus);
    ASSERT_TRUE(stimulus);
    const FollowingLag lag(s.rig, **stimulus);
    play(s, **stimulus, rate_Hz);
    EXPECT_NEAR(lag.s(), 0.008, 0.001) << rate_Hz;
  }
}

TEST(ControlPeriodOfTheGate, IsThatOfTheRigsSamples) {
  expect_the_lag_of_the_wheel([](Bench& s, const Stimulus&, double) {
    const CaseRecord r = s.run();
    ASSERT_FALSE(r.failure) << r.failure->error.to_text();
  });
}

TEST(ControlPeriodOfAProfile, IsThatOfTheRigsSamples) {
  expect_the_lag_of_the_wheel([](Bench& s, const Stimulus& stimulus, double rate_Hz) {
    PlayedProfile played;
    (void)play_profile(s.rig, stimulus, {}, s.job.safety, {}, nullptr, played);
    ASSERT_EQ(played.samples, static_cast<std::uint64_t>(60.0 * rate_Hz));
  });
}

}  // namespace
}  // namespace forcegate
