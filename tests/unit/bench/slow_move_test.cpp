// A wheel turned by hand: whoever ends it is told whether the motor stands.

#include "hil/rig/slow_move.h"

#include <gtest/gtest.h>

#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

using test::Changes;
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

TEST(SlowMove, ToWhereTheWheelStandsTellsWhatTheReferenceReads) {
  TwinBench b;
  b.mount();
  TwinBench::ok(b.session->open());
  const auto state = b.session->motor().read();
  ASSERT_TRUE(state) << state.error().to_text();
  const auto moved = move_slowly(*b.session, {state->theta_rad, 0.5, 0.01, nullptr});
  ASSERT_TRUE(moved) << moved.error().to_text();
  EXPECT_NEAR(moved->force_N, 0.5, 0.1);
}

TEST(SlowMove, ThatMeetsAnOverloadSaysSo) {
  TwinBench b;
  b.mount();
  b.say("fault reference saturation 0 1e9 0 0");
  const auto moved = move_slowly(*b.session, {1.0, 0.5, 0.01, nullptr});
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().code, ErrorCode::safety);
  EXPECT_EQ(moved.error().text, "the reference is overloaded: the motor is stopped");
}

TEST(SlowMove, DoesNotBeginFarOutsideTheTravel) {
  TwinBench b("twin.toml", {{"scale = 20860.756700940907", "scale = -20860.756700940907"}});
  b.mount();
  const auto moved = move_slowly(*b.session, {1.2, 0.5, 0.01, nullptr});
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().code, ErrorCode::device);
  EXPECT_NE(moved.error().text.find("outside its travel of 0 to 3.142 rad: the motor is stopped"), std::string::npos) << moved.error().to_text();
  EXPECT_NE(moved.error().hint.find("sign and scale of 'position'"), std::string::npos) << moved.error().to_text();
}

TEST(SlowMove, EndsAsSoonAsTheWheelTurnsAway) {
  // an angle of 2 rad where the wheel begins, which falls as the wheel rises
  TwinBench b("twin.toml", {{"scale = 20860.756700940907", "scale = -20860.756700940907, offset = 55145"}});
  b.mount();
  TwinBench::ok(b.session->open());
  const auto moved = move_slowly(*b.session, {2.5, 0.5, 0.01, nullptr});
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().code, ErrorCode::device);
  EXPECT_NE(moved.error().text.find("the wheel turns away from 2.50 rad: it stood at 2.00 rad"), std::string::npos) << moved.error().to_text();
  EXPECT_NE(moved.error().hint.find("'velocity_set'"), std::string::npos) << moved.error().to_text();
  const auto state = b.session->motor().read();
  ASSERT_TRUE(state);
  EXPECT_GT(state->theta_rad, 1.7) << "it has not gone far";
}

TEST(SlowMove, LeadsAWheelBackThatStandsALittleOutsideOfItsTravel) {
  TwinBench b("twin.toml", {{"scale = 20860.756700940907", "scale = 20860.756700940907, offset = 15510"}});
  b.mount();
  TwinBench::ok(b.session->open());
  const auto state = b.session->motor().read();
  ASSERT_TRUE(state);
  ASSERT_LT(state->theta_rad, -0.05);
  const auto moved = move_slowly(*b.session, {0.5, 0.5, 0.01, nullptr});
  ASSERT_TRUE(moved) << moved.error().to_text();
  EXPECT_NEAR(moved->to_rad, 0.5, 0.01);
}

// Seconds of the bench from where a record begins to 2 rad, at 5 rad/s if nothing limits it.
double seconds_to_2_rad(const Changes& changes) {
  TwinBench b("twin.toml", changes);
  b.mount();
  TwinBench::ok(b.session->open());
  const double begun_s = b.session->world().now_s();
  const auto moved = move_slowly(*b.session, {2.0, 5.0, 0.01, nullptr});
  EXPECT_TRUE(moved) << moved.error().to_text();
  return b.session->world().now_s() - begun_s;
}

TEST(SlowMove, IsCutToTheLimitsOfTheBench) {
  const double free_s = seconds_to_2_rad({});
  EXPECT_LT(free_s, 2.0);
  EXPECT_GT(seconds_to_2_rad({{"velocity_max_rad_per_s = 40.0", "velocity_max_rad_per_s = 0.2"}}), 5.0) << "more than a radian at 0.2 rad/s";
  EXPECT_GT(seconds_to_2_rad({{"force_rate_max_N_per_s = 100.0", "force_rate_max_N_per_s = 0.5"}}), 5.0) << "about 3 N at 0.5 N/s";
}

}  // namespace
}  // namespace forcegate
