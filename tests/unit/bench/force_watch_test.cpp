// The watch over a wheel that stands or creeps: what ends it, and what is said then.

#include "hil/rig/force_watch.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

using test::TwinBench;

TEST(ForceWatch, TellsTheForceOfABenchThatIsWell) {
  TwinBench b;
  b.run_up();
  ForceWatch watch(*b.session);
  EXPECT_TRUE(std::isnan(watch.force_N()));
  for (int i = 0; i < 5; ++i) TwinBench::ok(watch.look());
  EXPECT_FALSE(watch.readings().empty());
  EXPECT_NEAR(watch.force_N(), 0.5, 0.1);
}

TEST(ForceWatch, EndsAtAForceBeyondTheLimitWhileTheWheelStands) {
  TwinBench b("twin.toml", {{"force_max_N = 5.5", "force_max_N = 0.3"}});
  b.run_up();
  ForceWatch watch(*b.session);
  Result<MotorState> seen = watch.look();
  for (int i = 0; i < 5 && seen; ++i) seen = watch.look();
  ASSERT_FALSE(seen);
  EXPECT_EQ(seen.error().code, ErrorCode::safety);
  EXPECT_EQ(made_safe(*b.session, seen.error()).text.find("the force is 0."), 0U);
  EXPECT_FALSE(b.session->armed());
}

TEST(ForceWatch, EndsWhenTheReferenceFallsSilent) {
  TwinBench b;
  b.run_up();
  ForceWatch watch(*b.session);
  TwinBench::ok(watch.look());
  TwinBench::ok(b.session->reference().stop());
  Result<MotorState> seen = watch.look();
  for (int i = 0; i < 50 && seen; ++i) seen = watch.look();
  ASSERT_FALSE(seen);
  EXPECT_EQ(made_safe(*b.session, seen.error()).text, "the reference is silent: the motor is stopped");
}

TEST(ForceWatch, EndsWhenTheGuardOfTheMotorHasLeft) {
  TwinBench b("twin.toml", {{"clock = \"virtual\"", "clock = \"paced\""}, {"drive_timeout_ms = 200", "drive_timeout_ms = 5000"}});
  b.run_up();
  ForceWatch watch(*b.session);
  TwinBench::ok(watch.look());
  TwinBench::ok(b.session->motor().command_velocity(0.1));
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (b.status_text("stop_cause") != "control-word" && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // until the guard has left
  const Result<MotorState> seen = watch.look();
  ASSERT_FALSE(seen);
  EXPECT_EQ(seen.error().code, ErrorCode::safety);
  EXPECT_NE(seen.error().text.find("held up"), std::string::npos) << seen.error().to_text();
}

}  // namespace
}  // namespace forcegate
