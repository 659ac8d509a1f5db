// Adapters that are programs of their own: every way in which such a program can fail, and the ones in Python.

#include <gtest/gtest.h>
#include <stdlib.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <thread>

#include "adapters/process/messages.h"
#include "adapters/transport/child_process.h"
#include "adapters/transport/private_folder.h"
#include "hil/base/device_clock.h"
#include "hil/base/rng.h"
#include "hil/rig/config.h"
#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

using Steady = std::chrono::steady_clock;
using test::TwinBench;

/// The clock on the wall and nothing else.
class WallWorld final : public BenchWorld {
 public:
  Result<std::string> serial_path(const std::string& port) override { return port; }
  Result<std::unique_ptr<Transport>> open_line(const std::string&, const LineSettings&) override {
    return fail(ErrorCode::internal, "no line");
  }
  Result<std::unique_ptr<Transport>> open_hid(unsigned short, unsigned short, const std::string&) override {
    return fail(ErrorCode::internal, "no HID device");
  }
  Result<std::unique_ptr<Transport>> open_datagrams(const std::string&, const std::string&, int) override {
    return fail(ErrorCode::internal, "no datagrams");
  }
  Result<int> tcp_port(const std::string&, int declared) override { return declared; }
  double now_s() const override { return std::chrono::duration<double>(Steady::now() - start_).count(); }
  Result<void> advance_to(double) override { return {}; }
  bool is_virtual() const override { return false; }
  Result<void> mount(const RigRecordRequest&) override { return {}; }
  bool flashes() const override { return false; }
  Result<void> flash(const std::string&) override { return {}; }

 private:
  Steady::time_point start_ = Steady::now();
};

std::string table_text(const std::string& device, const std::string& fault) {
  const std::string common = "command = [\"/usr/bin/python3\", \"" FORCEGATE_SOURCE_DIR
                             "/tests/support/scripted_adapter.py\", \"" +
                             device + "\", \"" + fault +
                             "\"]\nfolder = \"/tmp\"\nreply_timeout_ms = 1500\nstart_timeout_ms = 20000\n";
  if (device == "motor") return common + "velocity_max_rad_per_s = 10\ndrive_timeout_ms = 200\n";
  if (device == "board") return common + "serial = \"B\"\n";
  return common +
         "rate_Hz = 100\nu_time_s = 0.001\nresolution_N = 0.01\nforce_max_N = 17\nserial = \"S\"\ncalibration_id = \"C\"\n";
}

template <class Kind>
auto make_device(const std::string& device, const std::string& fault, BenchWorld& world) {
  auto table = parse_config(table_text(device, fault), "bench.toml");
  EXPECT_TRUE(table);
  auto made = Registry<Kind>::instance().find("process")->make(*table, world);
  EXPECT_TRUE(made) << made.error().to_text();
  return std::move(*made);
}

// The error, when there is one, names the device; no call takes longer than its timeout and a farewell.
void expect_named(const Result<void>& result, const std::string& device) {
  if (result) return;
  EXPECT_TRUE(result.error().where.starts_with(device + ":")) << result.error().to_text();
  EXPECT_FALSE(result.error().text.empty());
}

constexpr const char* kFaults[] = {"die",
                                   "killed",
                                   "hang",
                                   "late",
                                   "silent",
                                   "garbage",
                                   "half",
                                   "endless",
                                   "wrong_id",
                                   "old_id",
                                   "twice",
                                   "no_object",
                                   "not_a_number",
                                   "infinite",
                                   "text",
                                   "error",
                                   "error_without_text",
                                   "future",
                                   "past",
                                   "absurd",
                                   "short_row",
                                   "no_clock"};
class ProgramFault : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Matrix, ProgramFault, testing::ValuesIn(kFaults),
                         [](const auto& one) { return std::string(one.param); });

TEST_P(ProgramFault, OfAReferenceNeverShowsAWrongForce) {
  WallWorld world;
  const auto reference = make_device<ReferenceKind>("reference", GetParam(), world);
  ASSERT_TRUE(reference->open());
  ASSERT_TRUE(reference->start());
  std::vector<ReferenceReading> readings;
  Result<void> polled;
  for (int i = 0; i < 6 && polled; ++i) polled = reference->poll(readings);
  expect_named(polled, "reference");
  EXPECT_GE(readings.size(), 2U);
  for (const ReferenceReading& r : readings) {
    if (!std::isnan(r.force_N)) {
      EXPECT_EQ(r.force_N, 1.5F);
    } else {
      EXPECT_NE(r.status, 0U);
    }
    EXPECT_LE(r.t_s, world.now_s() + 0.02);
  }
  reference->close();
}

TEST(ProgramAdapter, AnAnswerUnderAnotherIdIsToldWithBoth) {
  WallWorld world;
  const auto reference = make_device<ReferenceKind>("reference", "wrong_id", world);
  ASSERT_TRUE(reference->open());
  ASSERT_TRUE(reference->start());
  std::vector<ReferenceReading> readings;
  Result<void> polled;
  for (int i = 0; i < 6 && polled; ++i) polled = reference->poll(readings);
  ASSERT_FALSE(polled);
  EXPECT_NE(polled.error().text.find("answers 'poll' under the id 10"), std::string::npos) << polled.error().to_text();
  reference->close();
}

TEST(ProgramAdapter, AForceThatChangedDuringASilenceIsNoJump) {
  WallWorld world;
  const auto reference = make_device<ReferenceKind>("reference", "gap", world);
  ASSERT_TRUE(reference->open());
  ASSERT_TRUE(reference->start());
  std::vector<ReferenceReading> readings;
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(reference->poll(readings));
  ASSERT_EQ(readings.size(), 5U) << reference->counts().at("unbelievable readings refused") << " refused";
  EXPECT_EQ(readings.back().force_N, 9.0F);
}

TEST_P(ProgramFault, OfABoardNeverShowsAWrongSample) {
  WallWorld world;
  const auto board = make_device<BoardKind>("board", GetParam(), world);
  ASSERT_TRUE(board->open());
  ASSERT_TRUE(board->start());
  std::vector<BoardSample> samples;
  Result<void> polled;
  for (int i = 0; i < 6 && polled; ++i) polled = board->poll(samples);
  expect_named(polled, "board");
  EXPECT_GE(samples.size(), 2U);
  for (const BoardSample& s : samples) EXPECT_EQ(s.adc, 1000U + s.index);
  EXPECT_EQ(board->counters().indices_lost, samples.back().index + 1 - samples.size());
  board->close();
}

TEST_P(ProgramFault, OfAMotorNeverShowsAWrongAngleAndItIsStopped) {
  auto folder = PrivateFolder::make();
  ASSERT_TRUE(folder);
  const auto stopped = folder->path() / "stopped";
  setenv("SCRIPTED_STOP", stopped.c_str(), 1);
  WallWorld world;
  const auto motor = make_device<MotorKind>("motor", GetParam(), world);
  ASSERT_TRUE(motor->open());
  ASSERT_TRUE(motor->arm());
  Result<void> done;
  for (int i = 1; i < 6 && done; ++i) {
    const auto state = motor->read();
    if (!state)
      done = Unexpected(state.error());
    else
      EXPECT_EQ(state->theta_rad,
                i);  // the script counts its readings: an earlier answer would show an earlier number
  }
  expect_named(done, "motor");
  const auto parked = motor->emergency();
  EXPECT_TRUE(parked) << parked.error().to_text();
  EXPECT_TRUE(std::filesystem::exists(stopped));
  EXPECT_FALSE(motor->command_velocity(1.0));
  unsetenv("SCRIPTED_STOP");
}

TEST(ProgramAdapter, ADriveThatStopsRunningUntoldIsAnError) {
  for (const bool told : {true, false}) {
    WallWorld world;
    const auto motor = make_device<MotorKind>("motor", "begins_anew", world);
    ASSERT_TRUE(motor->open());
    ASSERT_TRUE(motor->arm());
    if (told) {
      ASSERT_TRUE(motor->command_velocity(1.0));
    }
    ASSERT_TRUE(motor->read());
    ASSERT_TRUE(motor->read());
    const auto state = motor->read();
    EXPECT_EQ(state.has_value(), !told);
    if (!state) {
      EXPECT_NE(state.error().text.find("nobody told it to"), std::string::npos) << state.error().to_text();
    }
  }
}

TEST(ProgramAdapter, OneThatCannotBeStartedIsNamed) {
  WallWorld world;
  auto table = parse_config("command = [\"/no/such/program\"]\nserial = \"B\"\n", "bench.toml");
  auto board = Registry<BoardKind>::instance().find("process")->make(*table, world);
  ASSERT_TRUE(board) << board.error().to_text();
  const auto opened = (*board)->open();
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::config);
  EXPECT_NE(opened.error().text.find("/no/such/program"), std::string::npos);
}

TEST(ProgramAdapter, ThatIsSilentIsToldWithTheTimeoutThatRanOut) {
  WallWorld world;
  auto table = parse_config("command = [\"/bin/sleep\", \"30\"]\nfolder = \"/tmp\"\nserial = \"B\"\nreply_timeout_ms = 10\nstart_timeout_ms = 150\n", "bench.toml");
  ASSERT_TRUE(table);
  auto board = Registry<BoardKind>::instance().find("process")->make(*table, world);
  ASSERT_TRUE(board) << board.error().to_text();
  const auto opened = (*board)->open();
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::timeout);
  EXPECT_NE(opened.error().hint.find("raise start_timeout_ms (150)"), std::string::npos) << opened.error().to_text();
}

TEST(ProgramAdapter, AnotherInstrumentThanThatOfTheFileIsRefused) {
  WallWorld world;
  const auto board = make_device<BoardKind>("board", "other_serial", world);
  const auto reference = make_device<ReferenceKind>("reference", "other_serial", world);
  for (const auto& opened : {board->open(), reference->open()}) {
    ASSERT_FALSE(opened);
    EXPECT_EQ(opened.error().code, ErrorCode::device);
    EXPECT_NE(opened.error().text.find("has serial number X, the bench file says "), std::string::npos) << opened.error().to_text();
  }
  const auto silent = make_device<BoardKind>("board", "none", world)->open();
  ASSERT_TRUE(silent) << silent.error().to_text();
  EXPECT_EQ(silent->serial, "B");
  EXPECT_TRUE(silent->by_file) << "a board that cannot tell";
}

TEST(ProgramAdapter, RunsInTheFolderOfABenchFileWhoseNameHasAColon) {
  auto folder = PrivateFolder::make();
  ASSERT_TRUE(folder);
  const auto home = folder->path() / "at 08:30";
  std::filesystem::create_directories(home);
  WallWorld world;
  std::string text = table_text("board", "in_folder");
  for (const auto& [from, to] : test::Changes{{"folder = \"/tmp\"\n", ""}, {"serial = \"B\"", "serial = \"at 08:30\""}})
    text.replace(text.find(from), from.size(), to);
  auto table = parse_config(text, (home / "bench.toml").string());
  ASSERT_TRUE(table);
  auto board = Registry<BoardKind>::instance().find("process")->make(*table, world);
  ASSERT_TRUE(board) << board.error().to_text();
  const auto opened = (*board)->open();
  ASSERT_TRUE(opened) << opened.error().to_text();
  EXPECT_FALSE(opened->by_file) << "it told the folder that it runs in";
}

TEST(ProgramAdapter, OfARelativeNameLiesBesideTheBenchFileWhereverItRuns) {
  auto folder = PrivateFolder::make();
  ASSERT_TRUE(folder);
  std::filesystem::create_directories(folder->path() / "here");
  const auto program = folder->path() / "adapter.sh";
  std::ofstream(program) << "#!/bin/sh\nexec /usr/bin/python3 " FORCEGATE_SOURCE_DIR "/tests/support/scripted_adapter.py board in_folder\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  auto table = parse_config("command = [\"./adapter.sh\"]\nfolder = \"here\"\nserial = \"here\"\nstart_timeout_ms = 20000\n", (folder->path() / "bench.toml").string());
  ASSERT_TRUE(table);
  WallWorld world;
  auto board = Registry<BoardKind>::instance().find("process")->make(*table, world);
  ASSERT_TRUE(board) << board.error().to_text();
  const auto opened = (*board)->open();
  ASSERT_TRUE(opened) << opened.error().to_text();
  EXPECT_FALSE(opened->by_file) << "it told the folder that it runs in";
}

TEST(ProgramMessages, RequestsAreOneLineAndTablesBecomeObjects) {
  const auto table = parse_config("a = 1\nb = \"x\\ny\"\nc = [1.5, true]\n", "t");
  ASSERT_TRUE(table);
  EXPECT_EQ(
      process::encode_request(7, "open", 0.5,
                              {{"options", &*table}, {"port", std::string("/dev/x")}, {"exclusive", true}}),
      R"({"id":7,"do":"open","now_s":0.5,"options":{"a":1,"b":"x\ny","c":[1.5,true]},"port":"/dev/x","exclusive":true})");
}

TEST(ProgramMessages, ANumberThatJsonDoesNotHaveIsNamedWithWhatToWrite) {
  const auto reply = process::decode_reply(R"({"id": 3, "ok": true, "clock_s": 1.0, "rows": [[2.0, NaN, 0]]})");
  ASSERT_FALSE(reply);
  EXPECT_NE(reply.error().text.find("says NaN or Infinity, which is no JSON"), std::string::npos) << reply.error().text;
  EXPECT_NE(reply.error().hint.find("write null"), std::string::npos);
}

TEST(DeviceClock, FindsOffsetAndSkewWhateverTheDelays) {
  DeviceClock clock;
  Rng rng(3, "device_clock");
  // Device runs 80 ppm fast and 5 s ahead.
  for (int i = 0; i < 400; ++i) {
    const double t = 0.05 * i, out = 0.001 + 0.01 * rng.uniform() * rng.uniform(),
                 back = 0.001 + 0.01 * rng.uniform() * rng.uniform();
    clock.add(t, 5.0 + (t + out) * (1.0 + 80e-6), t + out + back);
  }
  const ClockFit fit = clock.fit();
  EXPECT_EQ(fit.exchanges, 400U);
  EXPECT_NEAR(fit.skew_ppm, -80.0, 30.0);
  EXPECT_LT(fit.u_s, 0.001);
  const double device = 5.0 + 20.0 * (1.0 + 80e-6);
  EXPECT_NEAR(clock.bench_s(device), 20.0, 3.0 * fit.u_s);
  EXPECT_GT(fit.residual_s, 0.0);
  EXPECT_LT(fit.residual_s, 0.002);
}

TEST(PythonAdapters, TurnTheWheelAndReadForceAndBoardOfTheTwins) {
  // Long waits, so that a busy machine is no fault of the drive.
  TwinBench b("twin_python.toml",
              {{"drive_timeout_ms = 500",
                "drive_timeout_ms = 5000\nreply_timeout_ms = 20000\nstart_timeout_ms = 20000"}});
  ASSERT_TRUE(b.session);
  b.run_up();
  BenchSession& s = *b.session;
  const double start = s.motor().read().value().theta_rad;
  std::vector<ReferenceReading> readings;
  std::vector<BoardSample> samples;
  double theta = start;
  for (int i = 0; i < 3000 && theta < start + 0.3; ++i) {
    TwinBench::ok(s.motor().command_velocity(1.0));
    TwinBench::ok(b.advance(0.01));
    const auto state = s.motor().read();
    TwinBench::ok(state);
    if (!state) return;
    theta = state->theta_rad;
    TwinBench::ok(s.reference().poll(readings));
    TwinBench::ok(s.board().poll(samples));
  }
  EXPECT_GE(theta, start + 0.3);
  TwinBench::ok(s.motor().stop());
  for (int i = 0; i < 500 && std::fabs(b.status("velocity_rad_per_s")) > 1e-4; ++i)
    TwinBench::ok(b.advance(0.01));
  readings.clear();
  for (int i = 0; i < 500 && readings.size() < 60; ++i) {
    TwinBench::ok(b.advance(0.01));
    TwinBench::ok(s.motor().read());
    TwinBench::ok(s.reference().poll(readings));
    TwinBench::ok(s.board().poll(samples));
  }
  EXPECT_NEAR(s.motor().read().value().theta_rad, b.status("theta_rad"), 1e-4);
  ASSERT_FALSE(readings.empty());
  EXPECT_NEAR(static_cast<double>(readings.back().force_N), b.status("force_N"), 0.05);  // noise of the cell
  ASSERT_GT(samples.size(), 100U);
  EXPECT_EQ(samples.back().index + 1, samples.size() + s.board().counters().indices_lost);
  s.make_safe();
  EXPECT_EQ(b.status_text("stop_cause"), "control-word");
}

TEST(PythonTwin, IsReadByTheAdapterOfARealBench) {
  auto folder = PrivateFolder::make();
  ASSERT_TRUE(folder);
  ChildProcess twin;
  const auto log = folder->path() / "log";
  ASSERT_TRUE(twin.start({"/usr/bin/python3", "-m", "forcegate_adapter", "twin"},
                         FORCEGATE_SOURCE_DIR "/adapters/python", log));
  std::string port;
  for (int i = 0; i < 2000 && port.empty(); ++i) {
    const std::string said = last_line(log);
    const std::size_t from = said.find("/dev/pts/");
    if (from != std::string::npos) port = said.substr(from, said.find(';', from) - from);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ASSERT_FALSE(port.empty()) << last_line(log);
  const auto root = parse_config("[ports]\nati = \"" + port + "\"\n", "lab.toml");
  auto world = Registry<BenchWorldKind>::instance().find("real")->make(*root, {});
  ASSERT_TRUE(world);
  const auto table = parse_config(
      "port = \"ati\"\ncounts_per_force = 1000\nresolution_N = 0.025\nforce_max_N = 17\nserial = \"S\"\ncalibration_id = \"C\"\n",
      "lab.toml");
  auto ati = Registry<ReferenceKind>::instance().find("ati_serial")->make(*table, **world);
  ASSERT_TRUE(ati);
  const auto opened = (*ati)->open();
  ASSERT_TRUE(opened) << opened.error().to_text();
  ASSERT_TRUE((*ati)->start());
  std::vector<ReferenceReading> readings;
  for (int i = 0; i < 3000 && readings.size() < 200; ++i) {
    ASSERT_TRUE((*world)->advance_to((*world)->now_s() + 0.01));
    const auto polled = (*ati)->poll(readings);
    ASSERT_TRUE(polled) << polled.error().to_text();
  }
  ASSERT_GE(readings.size(), 200U);
  for (const ReferenceReading& r : readings) {
    EXPECT_GE(r.force_N, 0.99F);
    EXPECT_LE(r.force_N, 3.01F);
  }
}

}  // namespace
}  // namespace forcegate
