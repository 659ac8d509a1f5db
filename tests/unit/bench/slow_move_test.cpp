// A wheel turned by hand: whoever ends it is told whether the motor stands.

#include "hil/rig/slow_move.h"

#include <gtest/gtest.h>

#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

using test::TwinBench;

TEST(SlowMove, ThatIsInterruptedSaysThatTheMotorIsStopped) {
  TwinBench b;
  b.mount();
  const std::atomic<bool> stop{true};
  const auto moved = move_slowly(*b.session, {1.0, 0.5, 0.01, &stop});
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().code, ErrorCode::cancelled);
  EXPECT_EQ(moved.error().text, "interrupted: the motor is stopped");
}

TEST(SlowMove, SaysThatTheMotorMayTurnWhenTheStopDoesNotGetThrough) {
  TwinBench b("twin.toml", {{"response_timeout_ms = 1000", "response_timeout_ms = 20"}, {"drive_timeout_ms = 200", "drive_timeout_ms = 5000"}});
  b.mount();
  b.say("fault motor stall 0.05 1e9 0 0");
  const auto moved = move_slowly(*b.session, {1.0, 0.5, 0.01, nullptr});
  ASSERT_FALSE(moved);
  EXPECT_NE(b.status("command_rad_per_s"), 0.0);
  EXPECT_NE(moved.error().text.find("the motor may turn"), std::string::npos) << moved.error().to_text();
  EXPECT_NE(moved.error().hint.find("cut the power of the drive"), std::string::npos) << moved.error().to_text();
}

TEST(SlowMove, BeyondTheTravelSaysNothingOfAMotorThatNeverMoved) {
  TwinBench b;
  b.mount();
  const auto moved = move_slowly(*b.session, {-1.0, 0.5, 0.01, nullptr});
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().text, "-1.000 rad is outside the travel");
}

}  // namespace
}  // namespace forcegate
