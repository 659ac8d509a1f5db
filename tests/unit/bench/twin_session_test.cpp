// Real adapters against wire-level twins, in virtual time.

#include <gtest/gtest.h>

#include <cmath>

#include "hil/rig/self_check.h"
#include "hil/rig/slow_move.h"
#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

using test::Changes;
using test::TwinBench;

class OverBothLinks : public testing::TestWithParam<const char*> {};

TEST_P(OverBothLinks, TheWheelFollowsItsVelocityAndTheForceTheWheel) {
  TwinBench b(GetParam());
  b.run_up();
  BenchSession& s = *b.session;
  const double start = s.motor().read().value().theta_rad;
  TwinBench::ok(s.motor().command_velocity(1.5));
  std::vector<ReferenceReading> readings;
  std::vector<BoardSample> samples;
  for (int i = 0; i < 50; ++i) {
    TwinBench::ok(b.advance(0.01));
    TwinBench::ok(s.motor().read());
    TwinBench::ok(s.reference().poll(readings));
    TwinBench::ok(s.board().poll(samples));
  }
  const MotorState state = s.motor().read().value();
  EXPECT_NEAR(state.theta_rad - start, 1.5 * (0.5 - 0.008), 0.002);  // one drive time constant behind
  EXPECT_NEAR(state.theta_rad, b.status("theta_rad"), 1e-4);
  EXPECT_NEAR(state.velocity_rad_per_s, 1.5, 0.01);
  EXPECT_TRUE(state.running);
  ASSERT_EQ(samples.size(), 500U);
  EXPECT_EQ(samples.back().index, 499U);
  ASSERT_GT(readings.size(), 130U);  // 38400 baud: 274 records a second
  ASSERT_LT(readings.size(), 138U);
  EXPECT_NEAR(static_cast<double>(readings.back().force_N), b.status("force_N"), 0.06);
  EXPECT_NEAR(readings.back().t_s, s.world().now_s(), 0.013);  // transfer, look-ahead of one record, a period
  s.make_safe();
  EXPECT_EQ(b.status("command_rad_per_s"), 0.0);
  EXPECT_EQ(b.status_text("stop_cause"), "control-word");
}

INSTANTIATE_TEST_SUITE_P(Links, OverBothLinks, testing::Values("twin.toml", "twin_rtu.toml"));

TEST(TwinSession, NothingMovesBeforeItIsArmed) {
  TwinBench b;
  TwinBench::ok(b.session->open());
  const auto moved = b.session->motor().command_velocity(1.0);
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().code, ErrorCode::safety);
  TwinBench::ok(b.advance(0.1));
  EXPECT_EQ(b.status("command_rad_per_s"), 0.0);
}

TEST(TwinSession, ADriveThatCannotStopByItselfIsNotArmed) {
  // The register named for the timeout does not keep what is written to it.
  TwinBench b("twin.toml", {{"drive_timeout_reg = \"comm_timeout\"", "drive_timeout_reg = \"reset\""}});
  TwinBench::ok(b.session->open());
  const auto armed = b.session->arm();
  ASSERT_FALSE(armed);
  EXPECT_EQ(armed.error().code, ErrorCode::safety);
  EXPECT_NE(armed.error().text.find("timeout"), std::string::npos);
}

TEST(TwinSession, ASlowMoveStopsWhereTheForceIsBeyondTheLimitInEitherDirection) {
  for (const char* sign : {"1", "-1"}) {
    TwinBench b("twin.toml", {{"force_max_N = 5.5", "force_max_N = 1.0"}, {"counts_per_force = 1000\n", std::string("counts_per_force = 1000\nsign = ") + sign + "\n"}});
    b.mount();
    TwinBench::ok(b.session->open());
    const auto moved = move_slowly(*b.session, {.angle_rad = 1.5});
    ASSERT_FALSE(moved) << sign;
    EXPECT_EQ(moved.error().code, ErrorCode::safety) << moved.error().to_text();
    EXPECT_NE(moved.error().text.find("the force is "), std::string::npos) << moved.error().to_text();
    EXPECT_LT(b.status("force_N"), 1.3) << sign;
  }
}

TEST(TwinSession, ASilentHarnessIsStoppedByTheDrive) {
  TwinBench b;
  TwinBench::ok(b.session->open());
  TwinBench::ok(b.session->arm());
  TwinBench::ok(b.session->motor().command_velocity(2.0));
  const double told_s = b.status("t_s");
  TwinBench::ok(b.advance(0.5));  // nobody talks to the drive
  EXPECT_EQ(b.status_text("stop_cause"), "communication-timeout");
  EXPECT_NEAR(b.status("stop_s") - told_s, 0.2, 0.002);
  EXPECT_LT(b.status("still_s") - told_s, 0.28);
  const MotorState state = b.session->motor().read().value();
  EXPECT_TRUE(state.fault);
  EXPECT_EQ(state.fault_code, 0x84U);
}

TEST(TwinSession, AsciiRecordsGiveTheSameForces) {
  TwinBench b("twin.toml", {{"form = \"binary\"", "form = \"ascii\""}});
  b.mount();
  TwinBench::ok(b.session->open());
  TwinBench::ok(b.session->reference().start());
  std::vector<ReferenceReading> readings;
  for (int i = 0; i < 30; ++i) {
    TwinBench::ok(b.advance(0.01));
    TwinBench::ok(b.session->reference().poll(readings));
  }
  ASSERT_GT(readings.size(), 20U);  // 85 records a second
  for (const ReferenceReading& r : readings) EXPECT_NEAR(static_cast<double>(r.force_N), 0.5, 0.06);
}

class EveryReference : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(References, EveryReference,
                         testing::Values("twin.toml", "twin_netft.toml", "twin_digital.toml"));

TEST_P(EveryReference, AnOverloadIsSaid) {
  TwinBench b(GetParam());
  TwinBench::ok(b.session->open());
  TwinBench::ok(b.session->reference().start());
  b.say("fault reference saturation 0 1e9 0 0");
  std::vector<ReferenceReading> readings;
  for (int i = 0; i < 5; ++i) {
    TwinBench::ok(b.advance(0.01));
    TwinBench::ok(b.session->reference().poll(readings));
  }
  ASSERT_FALSE(readings.empty());
  for (const ReferenceReading& r : readings) {
    EXPECT_TRUE(std::isnan(r.force_N));
    EXPECT_EQ(r.status, kRigReferenceSaturated);
  }
}

class FastReference : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(References, FastReference, testing::Values("twin_netft.toml", "twin_digital.toml"));

TEST_P(FastReference, GivesEveryRowOfThePlantAtItsTime) {
  TwinBench b(GetParam());
  b.mount();
  BenchSession& s = *b.session;
  TwinBench::ok(s.open());
  TwinBench::ok(s.arm());
  TwinBench::ok(s.reference().start());
  TwinBench::ok(s.motor().command_velocity(1.0));
  std::vector<ReferenceReading> readings;
  for (int i = 0; i < 60; ++i) {
    TwinBench::ok(b.advance(0.01));
    TwinBench::ok(s.motor().read());
    TwinBench::ok(s.reference().poll(readings));
  }
  ASSERT_GE(readings.size(), 597U);  // the last ones wait for the records behind them
  EXPECT_NEAR(static_cast<double>(readings.back().force_N), b.status("force_N"), 0.02);
  // In the first clump no early arrival has told the clock yet.
  for (std::size_t i = 20; i < readings.size(); ++i)
    EXPECT_NEAR(readings[i].t_s - readings[i - 1].t_s, 0.001, 2e-4);
  EXPECT_NEAR(readings.back().t_s, s.world().now_s(), 0.004);
  s.make_safe();
}

TEST(NetFt, ABoxWithAnotherCalibrationIsRefused) {
  TwinBench b("twin_netft.toml", {{"counts_per_force = 1000000", "counts_per_force = 1234567"}});
  const auto opened = b.session->open();
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::config);
  EXPECT_NE(opened.error().text.find("1234567"), std::string::npos);
}

class LostRecords : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(NetFt, LostRecords, testing::Values("drop", "reset"));

// The wheel goes on while records are lost, or while the box is silent until it is asked again.
TEST_P(LostRecords, MakeAForceThatHasChangedNoJump) {
  TwinBench b("twin_netft.toml", {{"force_max_N = 17\n", "force_max_N = 17\njump_max_N = 0.3\n"}});
  b.run_up();
  BenchSession& s = *b.session;
  b.say(std::string("fault reference ") + (std::string(GetParam()) == "drop" ? "drop 0.2 0.09 0 0" : "reset 0.2 1e9 1 0"));
  std::vector<ReferenceReading> readings;
  for (int i = 0; i < 60; ++i) {
    TwinBench::ok(s.motor().command_velocity(4.0));
    TwinBench::ok(b.advance(0.01));
    TwinBench::ok(s.motor().read());
    const auto polled = s.reference().poll(readings);
    ASSERT_TRUE(polled) << polled.error().to_text();
  }
  EXPECT_EQ(s.reference().counts().at("unbelievable records"), 0U);
  ASSERT_FALSE(readings.empty());
  EXPECT_NEAR(static_cast<double>(readings.back().force_N), b.status("force_N"), 0.05);
}

TEST(NetFt, AStreamThatSomebodyElseHasTakenIsAskedForAgain) {
  TwinBench b("twin_netft.toml");
  TwinBench::ok(b.session->open());
  TwinBench::ok(b.session->reference().start());
  b.say("fault reference reset 0.05 1e9 1 0");
  std::vector<ReferenceReading> readings;
  for (int i = 0; i < 60; ++i) {
    TwinBench::ok(b.advance(0.01));
    TwinBench::ok(b.session->reference().poll(readings));
  }
  EXPECT_EQ(b.session->reference().counts().at("requests repeated"), 1U);
  ASSERT_FALSE(readings.empty());
  EXPECT_NEAR(readings.back().t_s, b.session->world().now_s(), 0.01);
}

TEST(DigitalFt, AnotherSensorThanTheBenchFileSaysIsRefused) {
  // The twin is made from the same file, so the sensor changes while nobody looks: another calibration is chosen.
  TwinBench b("twin_digital.toml", {{"calibration_index = 1", "calibration_index = 2"}});
  const auto opened = b.session->open();
  ASSERT_FALSE(opened);
  EXPECT_TRUE(opened.error().where.starts_with("reference")) << opened.error().to_text();
}

TEST(TwinSession, ACodeThatTheDeclaredConverterCannotGiveIsToldWithBothNumbers) {
  TwinBench b("twin.toml", {{"[board]", "[board]\nadc_bits = 12"}});
  b.mount("low_N=1 high_N=4");
  BenchSession& s = *b.session;
  TwinBench::ok(s.open());
  TwinBench::ok(s.board().start());
  std::vector<BoardSample> samples;
  Result<void> polled;
  for (int i = 0; i < 20 && polled; ++i) {
    TwinBench::ok(b.advance(0.01));
    polled = s.board().poll(samples);
  }
  ASSERT_FALSE(polled);
  EXPECT_EQ(polled.error().code, ErrorCode::config);
  EXPECT_NE(polled.error().text.find("adc_bits = 12 ends at 4095"), std::string::npos) << polled.error().text;
}

TEST(BoardClock, IsComparedByTimeMessagesWhileTheBoardStreams) {
  TwinBench b;
  BenchSession& s = *b.session;
  TwinBench::ok(s.open());
  TwinBench::ok(s.board().start());
  std::vector<BoardSample> samples;
  for (int i = 0; i < 600; ++i) {
    TwinBench::ok(b.advance(0.01));
    TwinBench::ok(s.board().poll(samples));
  }
  const ClockFit fit = s.board().clock();
  EXPECT_EQ(fit.exchanges, 12U);                       // twice a second
  EXPECT_NEAR(fit.skew_ppm, 0.0, 1.0);                 // one plant, one clock
  EXPECT_NEAR(fit.u_s, 0.005 / std::sqrt(3.0), 1e-4);  // an answer is looked for every 10 ms
  EXPECT_NE(s.details().at("board clock").find("12 exchanges"), std::string::npos);
}

// BENCH: after one stall every later RTU read was an answer to an earlier request, and libmodbus called it success.
TEST(TwinSession, ALateReplyIsNeverTakenForAFreshOne) {
  TwinBench b("twin_rtu.toml", {{"response_timeout_ms = 1000", "response_timeout_ms = 40"},
                                {"worst_reply_ms = 50", "worst_reply_ms = 150"}});
  TwinBench::ok(b.session->open());
  TwinBench::ok(b.session->arm());
  TwinBench::ok(b.session->motor().command_velocity(1.0));
  b.say("fault motor delay 0 1e9 2 100");  // two replies come 60 ms after their timeout
  for (int i = 0; i < 10; ++i) {
    TwinBench::ok(b.advance(0.01));
    const auto state = b.session->motor().read();
    TwinBench::ok(state);
    if (state) {
      EXPECT_NEAR(state->theta_rad, b.status("theta_rad"), 1e-3) << "period " << i;
    }
  }
  EXPECT_GT(b.session->motor().counts().at("retries"), 0U);
}

TEST(TwinSession, ACallThatHoldsTheLoopUpIsTimeThatTheHarnessWasLate) {
  TwinBench b("twin.toml", {{"clock = \"virtual\"", "clock = \"paced\""}});
  BenchSession& s = *b.session;
  TwinBench::ok(s.open());
  const double begin_s = s.world().now_s();
  const auto let_pass = [&](double seconds) { return s.world().advance_to(s.world().now_s() + seconds); };
  for (int i = 0; i < 20; ++i) {
    const double due_s = s.world().now_s();
    s.ticked(due_s);
    TwinBench::ok(s.timed("polling the sensor board", [&] { return let_pass(i == 10 ? 0.2 : 0.01); }));
  }
  const auto details = s.details();
  ASSERT_TRUE(details.contains(kSlowestCall) && details.contains(kLateTimeShare));
  EXPECT_TRUE(details.at(kSlowestCall).starts_with("polling the sensor board took 0.2")) << details.at(kSlowestCall);
  EXPECT_GT(std::stod(details.at(kLateTimeShare)), 0.15 / (s.world().now_s() - begin_s)) << "one late call of many";
  EXPECT_EQ(std::stod(details.at(kLateTickShare)), 0.0) << "no tick says so";
}

}  // namespace
}  // namespace forcegate
