// What stops the motor when nobody is left to do it.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "adapters/transport/private_folder.h"
#include "hil/rig/lease.h"
#include "rigs/emulated/twins/host.h"
#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

using test::bench_text;
using test::Changes;

/// Twins in a process of their own, as `forcegate bench serve` leaves them.
class Served : public testing::Test {
 protected:
  void serve(const std::string& file, const Changes& changes = {}) {
    auto made = PrivateFolder::make();
    ASSERT_TRUE(made);
    folder_.emplace(std::move(*made));
    setenv("XDG_RUNTIME_DIR", folder_->path().c_str(), 1);
    auto bench = read_bench_text(bench_text(file, changes), FORCEGATE_SOURCE_DIR "/rigs/" + file);
    ASSERT_TRUE(bench) << bench.error().to_text();
    bench_.emplace(std::move(*bench));
    const auto options = emulated::read_twin_options(bench_->root);
    ASSERT_TRUE(options);
    host_ = fork();
    if (host_ == 0) {
      auto host = emulated::TwinHost::make(*options, folder_->path());
      const std::atomic<bool> never{false};
      if (host) (*host)->serve(never, false);
      _exit(0);
    }
    auto hand = emulated::TwinClient::connect(folder_->path(), 20.0);
    ASSERT_TRUE(hand) << hand.error().to_text();
    hand_.emplace(std::move(*hand));
  }
  void TearDown() override {
    for (const pid_t p : {harness_, host_})
      if (p > 0) {
        kill(p, SIGKILL);
        waitpid(p, nullptr, 0);
      }
    unsetenv("XDG_RUNTIME_DIR");
  }
  std::map<std::string, std::string> options() const { return {{"attach", folder_->path().string()}}; }

  /// A harness that turns the wheel at 1 rad/s and says so; it never stops by itself.
  void start_harness() {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    harness_ = fork();
    if (harness_ == 0) {
      auto s = BenchSession::make(*bench_, options());
      bool good = s && (*s)->open() && (*s)->arm() && (*s)->motor().command_velocity(1.0);
      for (int i = 0; i < 5 && good; ++i)
        good = (*s)->world().advance_to((*s)->world().now_s() + 0.01) && (*s)->motor().read();
      const char told = good ? 'y' : 'n';
      (void)!write(ends[1], &told, 1);
      for (;;) pause();
    }
    close(ends[1]);
    char told = 'n';
    ASSERT_EQ(read(ends[0], &told, 1), 1);
    close(ends[0]);
    ASSERT_EQ(told, 'y');
    ASSERT_EQ(status("command_rad_per_s"), "1");
  }
  std::string status(const std::string& key) {
    auto s = hand_->status();
    return s ? (*s)[key] : "";
  }
  double number(const std::string& key) { return std::stod(status(key)); }
  void wait_until_still() {
    for (int i = 0; i < 4000 && (status("command_rad_per_s") != "0" || number("still_s") < 0.0); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }

  std::optional<PrivateFolder> folder_;
  std::optional<BenchFile> bench_;
  std::optional<emulated::TwinClient> hand_;
  pid_t host_ = -1, harness_ = -1;
};

class ServedOverEveryLink : public Served, public testing::WithParamInterface<const char*> {
 protected:
  // A drive that waits so long that it cannot be what stops.
  Changes patient_drive() const {
    const std::string own = std::string(GetParam()) == "twin_python.toml" ? "500" : "200";
    return {{"drive_timeout_ms = " + own, "drive_timeout_ms = 5000"}};
  }
};
INSTANTIATE_TEST_SUITE_P(Links, ServedOverEveryLink,
                         testing::Values("twin.toml", "twin_rtu.toml", "twin_python.toml"));

TEST_P(ServedOverEveryLink, AKilledHarnessIsParkedByItsGuardLongBeforeTheDriveGivesUp) {
  serve(GetParam(), patient_drive());
  start_harness();
  kill(harness_, SIGKILL);
  wait_until_still();
  EXPECT_EQ(status("stop_cause"), "control-word");
  EXPECT_EQ(status("command_rad_per_s"), "0");
  EXPECT_EQ(status("alarm"), "0");
}

TEST_F(Served, WithHarnessAndGuardGoneTheDriveStopsWithinItsOwnTimeout) {
  serve("twin.toml");
  start_harness();
  // A stopped process sends nothing, and its guard thinks that all is well: time is virtual and stands once what was under way has arrived.
  emulated::TwinClient& hand = *hand_;
  kill(harness_, SIGSTOP);
  siginfo_t stopped{};
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(harness_), &stopped, WSTOPPED), 0);
  double told_s = -1.0;
  while (told_s != number("t_s")) {
    told_s = number("t_s");
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ASSERT_TRUE(hand.say("advance 500"));
  EXPECT_EQ(status("stop_cause"), "communication-timeout");
  constexpr double kSample_s = 1e-3;  // the twin's time: what is due at a sample may be seen at the next one
  EXPECT_LE(number("stop_s") - told_s, 0.2005 + kSample_s);
  EXPECT_LE(number("still_s") - told_s, 0.25 + 2.0 * kSample_s);
}

TEST_P(ServedOverEveryLink, TheEmergencyStopReachesADriveThatSomebodyElseHolds) {
  serve(GetParam(), patient_drive());
  start_harness();
  const auto stopped = stop_motor_now(*bench_, options());
  ASSERT_TRUE(stopped) << stopped.error().to_text();
  EXPECT_EQ(status("command_rad_per_s"), "0");
  EXPECT_EQ(status("stop_cause"), "control-word");
}

TEST_F(Served, TwoRunsCannotHaveOneBench) {
  serve("twin.toml");
  start_harness();
  auto patient = options();
  patient["clock"] = "paced";  // time stays with the run that has the bench
  auto second = BenchSession::make(*bench_, patient);
  ASSERT_TRUE(second);
  const auto opened = (*second)->open();
  ASSERT_FALSE(opened);
  EXPECT_NE(opened.error().text.find(std::to_string(harness_)), std::string::npos)
      << opened.error().to_text();
  const auto holder = lease_holder(bench_->id);
  ASSERT_TRUE(holder && *holder);
  EXPECT_EQ((*holder)->pid, harness_);
  kill(harness_, SIGKILL);
  waitpid(harness_, nullptr, 0);
  harness_ = -1;
  // No lock is orphaned: the kernel has freed it with its holder.
  EXPECT_FALSE(lease_holder(bench_->id)->has_value());
  wait_until_still();
  EXPECT_TRUE((*second)->open());
}

std::atomic<int> g_broken_pipes{0};

TEST(ParkGuard, ThatHasStoppedTheMotorEndsNobodyByASignal) {
  const auto before = std::signal(SIGPIPE, [](int) { ++g_broken_pipes; });
  ParkGuard guard;
  ASSERT_TRUE(guard.start([] {}, 0.02));
  EXPECT_TRUE(guard.beat());
  siginfo_t left{};
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(guard.id()), &left, WEXITED | WNOWAIT), 0);
  EXPECT_FALSE(guard.beat());
  guard.dismiss();
  std::signal(SIGPIPE, before);
  EXPECT_EQ(g_broken_pipes, 0);
}

TEST(ParkGuard, ThatIsGoneEndsTheMotionOfAHarnessThatWasHeldUp) {
  test::TwinBench b("twin.toml", {{"clock = \"virtual\"", "clock = \"paced\""}, {"drive_timeout_ms = 200", "drive_timeout_ms = 5000"}});
  b.run_up();
  test::TwinBench::ok(b.session->motor().command_velocity(0.1));
  test::TwinBench::ok(b.session->beat());
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (b.status_text("stop_cause") != "control-word" && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // until the guard has left
  const auto beaten = b.session->beat();
  ASSERT_FALSE(beaten);
  EXPECT_NE(beaten.error().text.find("held up"), std::string::npos) << beaten.error().to_text();
}

TEST(RealBench, DoesNotMoveWithoutItsOption) {
  Changes changes{{"[twins]\nsensor = \"flexiforce\"\nclock = \"virtual\"\nati_counts_per_N = 1000\n", ""}};
  auto bench = read_bench_text(bench_text("twin.toml", changes), "lab.toml");
  ASSERT_TRUE(bench) << bench.error().to_text();
  EXPECT_FALSE(bench->twins);
  auto s = BenchSession::make(std::move(*bench), {});
  ASSERT_TRUE(s) << s.error().to_text();
  const auto armed = (*s)->arm();
  ASSERT_FALSE(armed);
  EXPECT_EQ(armed.error().code, ErrorCode::safety);
  EXPECT_NE(armed.error().hint.find("--arm"), std::string::npos);
}

}  // namespace
}  // namespace forcegate
