#include <signal.h>
#include <sys/wait.h>

#include <fstream>

#include "adapters/transport/child_process.h"
#include "adapters/transport/private_folder.h"
#include "tests/unit/firmware/record.h"
#include "tests/unit/firmware/run.h"

namespace forcegate::test {
namespace {

class Lanes : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!find_program("qemu-system-arm") || !std::filesystem::exists(image("reference.uart.elf")))
      GTEST_SKIP() << "needs qemu-system-arm and the cross-compiled images";
  }
  const Calibration calibration_ = calibration_of(0.47, 0.11);
};

TEST_F(Lanes, M4fAndM3SoftFloatGiveTheNativeBitsOverTwentyMinutes) {
  const Record r = decaying_sine({.gain_N_per_V = 0.47, .offset_N = 0.11});
  const auto native = run("native", image("reference.native.so"), calibration_, r.adc);
  ASSERT_TRUE(native);
  for (const char* name :
       {"reference-m4f.block.elf", "reference-m3.block.elf", "mutants/optimised_for_size-m4f.block.elf"}) {
    const auto block = run("block", image(name), calibration_, r.adc, 65536);
    ASSERT_TRUE(block) << block.error().to_text();
    EXPECT_EQ(block->force_N, native->force_N) << name;
    EXPECT_EQ(block->flags, native->flags) << name;
    EXPECT_EQ(block->info.algorithm_id, native->info.algorithm_id);
    EXPECT_EQ(block->info.build_id.size(), 40U);
  }
}

TEST_F(Lanes, UartGivesTheNativeBitsOverAMinuteWithoutALostFrame) {
  const Record r = decaying_sine({.duration_s = 60.0});
  const auto native = run("native", image("reference.native.so"), calibration_, r.adc);
  const auto uart = run("uart", image("reference.uart.elf"), calibration_, r.adc);
  ASSERT_TRUE(native);
  ASSERT_TRUE(uart) << uart.error().to_text();
  EXPECT_EQ(uart->force_N, native->force_N);
  EXPECT_EQ(uart->flags, native->flags);
  EXPECT_EQ(uart->counters.samples, r.adc.size());
  EXPECT_EQ(uart->counters.frames_dropped + uart->counters.frames_bad + uart->counters.indices_lost, 0U);
}

TEST_F(Lanes, BlocksOfAControlPeriodGiveTheSameBitsAsLongOnes) {
  const Record r = decaying_sine({.duration_s = 30.0});
  const auto many = run("block", image("reference-m4f.block.elf"), calibration_, r.adc, 10);
  const auto few = run("block", image("reference-m4f.block.elf"), calibration_, r.adc, 30000);
  ASSERT_TRUE(many && few);
  EXPECT_EQ(many->force_N, few->force_N);
}

TEST_F(Lanes, TheCostOfASampleIsTheSameOnEveryRunAndTheForceThatOfTheOtherLanes) {
  const Record r = decaying_sine({.duration_s = 25.0});
  const auto native = run("native", image("reference.native.so"), calibration_, r.adc);
  ASSERT_TRUE(native);
  for (const char* name : {"reference-m4f.block.elf", "reference-m3.block.elf"}) {
    const auto first = run("tick", image(name), calibration_, r.adc);
    const auto second = run("tick", image(name), calibration_, r.adc, 10);
    ASSERT_TRUE(first && second) << name;
    EXPECT_EQ(first->force_N, native->force_N) << name;
    EXPECT_EQ(first->flags, native->flags) << name;
    EXPECT_GT(first->resources.instructions_worst, first->resources.instructions_mean);
    EXPECT_GT(first->resources.instructions_mean, 50.0);
    EXPECT_EQ(first->resources.instructions_worst, second->resources.instructions_worst) << name;
    EXPECT_EQ(first->resources.instructions_mean, second->resources.instructions_mean) << name;
    EXPECT_EQ(first->resources.late, 0.0);
    EXPECT_GT(first->resources.stack_bytes, 50.0);
    EXPECT_LT(first->resources.stack_bytes, 2000.0);
    EXPECT_GT(first->resources.flash_bytes, 3000.0);
    EXPECT_GT(first->resources.ram_bytes, 2000.0);
  }
}

TEST_F(Lanes, AResetInTheRunningImageForgetsTheSessionBefore) {
  const Record before = decaying_sine({.duration_s = 25.0}, 3), r = decaying_sine({.duration_s = 25.0});
  for (const auto& [lane, file] : {std::pair{"native", "reference.native.so"},
                                   {"block", "reference-m4f.block.elf"},
                                   {"uart", "reference.uart.elf"}}) {
    const auto fresh = run(lane, image(file), calibration_, r.adc);
    const auto again =
        run_after(lane, image(file), calibration_of(0.9, -0.2), before.adc, calibration_, r.adc);
    ASSERT_TRUE(fresh && again) << lane << (again ? "" : again.error().to_text());
    EXPECT_EQ(again->force_N, fresh->force_N) << lane;
    EXPECT_EQ(again->flags, fresh->flags) << lane;
  }
}

TEST_F(Lanes, AnImageInTheWrongLaneIsAUsageErrorThatNamesTheRightOne) {
  const auto wrong = run("block", image("reference.uart.elf"), calibration_, {});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::usage);
  EXPECT_NE(wrong.error().hint.find("uart"), std::string::npos);
}

TEST_F(Lanes, ASessionOfAnotherRateIsToldInEveryLaneAndIsNobodysFaultYet) {
  for (const auto& [lane, file] : {std::pair{"native", "reference.native.so"},
                                   {"block", "reference-m4f.block.elf"},
                                   {"tick", "reference-m4f.block.elf"},
                                   {"uart", "reference.uart.elf"}}) {
    DutSession session;
    session.image = image(file);
    session.calibration = calibration_;
    session.rate_Hz = 200.0;
    auto dut = make_dut(lane, {});
    ASSERT_TRUE(dut);
    const auto opened = (*dut)->open(session);
    ASSERT_FALSE(opened) << lane;
    EXPECT_EQ(opened.error().code, ErrorCode::config) << lane;
    EXPECT_NE(opened.error().hint.find("--rate 1000"), std::string::npos) << lane;
  }
}

TEST_F(Lanes, AMissingEmulatorIsAConfigurationErrorWithThePackage) {
  const auto lane = make_dut("block", {{"qemu", "no-such-emulator"}});
  ASSERT_FALSE(lane);
  EXPECT_EQ(lane.error().code, ErrorCode::config);
  EXPECT_NE(lane.error().hint.find("qemu-system-arm"), std::string::npos);
}

TEST_F(Lanes, ADeadOrSilentEmulatorIsAFirmwareError) {
  DutSession session;
  session.image = image("reference-m4f.block.elf");
  auto dead = make_dut("block", {{"qemu", "/bin/false"}});
  ASSERT_TRUE(dead);
  const auto ended = (*dead)->open(session);
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, ErrorCode::firmware);
  EXPECT_NE(ended.error().text.find("exit code 1"), std::string::npos);
  auto folder = PrivateFolder::make();
  ASSERT_TRUE(folder);
  const std::filesystem::path sleeper = folder->path() / "sleeper";
  std::ofstream(sleeper) << "#!/bin/sh\nexec sleep 60\n";
  std::filesystem::permissions(sleeper, std::filesystem::perms::owner_all);
  auto silent = make_dut("block", {{"qemu", sleeper.string()}, {"timeout_s", "0.3"}});
  ASSERT_TRUE(silent);
  const auto late = (*silent)->open(session);
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::firmware);
  EXPECT_NE(late.error().text.find("no answer"), std::string::npos);
}

// What the host did is nobody's: a stopped emulator answers again, and one that is never let on is no failure of the image.
TEST_F(Lanes, TimeInWhichTheEmulatorWasStoppedIsNotTheImages) {
  const PrivateFolder folder = PrivateFolder::make().value();
  const std::filesystem::path stopped = folder.path() / "stopped";
  std::ofstream(stopped) << "#!/bin/sh\nkill -STOP $$\nsleep 60\n";
  std::filesystem::permissions(stopped, std::filesystem::perms::owner_all);
  for (const auto& [lane, name] : {std::pair{"block", "reference-m4f.block.elf"}, {"uart", "reference.uart.elf"}}) {
    const auto got = (*make_dut(lane, {{"qemu", stopped.string()}, {"timeout_s", "0.4"}}))->open(session_of(image(name), calibration_));
    ASSERT_FALSE(got) << lane;
    EXPECT_EQ(got.error().code, ErrorCode::timeout) << lane << ": " << got.error().to_text();
  }
  const std::filesystem::path late = folder.path() / "late";
  std::ofstream(late) << "#!/bin/sh\n(sleep 3; kill -CONT $$) &\nkill -STOP $$\nexec " << find_program("qemu-system-arm")->string() << " \"$@\"\n";
  std::filesystem::permissions(late, std::filesystem::perms::owner_all);
  const auto dut = make_dut("block", {{"qemu", late.string()}, {"timeout_s", "2.5"}});
  const auto opened = (*dut)->open(session_of(image("reference-m4f.block.elf"), calibration_));
  EXPECT_TRUE(opened) << opened.error().to_text();
}

TEST_F(Lanes, AnImageThatGivesNoAccountAtItsEndLeavesNoEmulatorRunning) {
  const PrivateFolder folder = PrivateFolder::make().value();
  const std::filesystem::path qemu = folder.path() / "qemu";
  std::ofstream(qemu) << "#!/bin/sh\necho $$ > " << (folder.path() / "pid").string() << "\nexec " << find_program("qemu-system-arm")->string() << " \"$@\"\n";
  std::filesystem::permissions(qemu, std::filesystem::perms::owner_all);
  const auto dut = make_dut("tick", {{"qemu", qemu.string()}, {"timeout_s", "3"}});
  ASSERT_TRUE(dut);
  const auto opened = (*dut)->open(session_of(image("reference-m4f.block.elf"), calibration_));
  ASSERT_TRUE(opened) << opened.error().to_text();
  pid_t pid = 0;
  std::ifstream(folder.path() / "pid") >> pid;
  ASSERT_GT(pid, 1);
  kill(pid, SIGSTOP);
  siginfo_t stopped{};
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(pid), &stopped, WSTOPPED), 0);  // until then a thread of it may answer
  ASSERT_FALSE((*dut)->close());
  EXPECT_EQ(kill(pid, 0), -1) << "the emulator is still there";
}

TEST_F(Lanes, AFileThatIsCutShortIsNeverWhatWasBuilt) {
  const PrivateFolder folder = PrivateFolder::make().value();
  for (const auto& [lane, name] : {std::pair{"block", "reference-m4f.block.elf"}, {"tick", "reference-m4f.block.elf"}, {"uart", "reference.uart.elf"}}) {
    for (const double share : {0.5, 0.75, 0.98}) {
      const std::filesystem::path cut = folder.path() / name;
      std::filesystem::copy_file(image(name), cut, std::filesystem::copy_options::overwrite_existing);
      std::filesystem::resize_file(cut, static_cast<std::uintmax_t>(share * static_cast<double>(std::filesystem::file_size(image(name)))));
      const auto got = (*make_dut(lane))->open(session_of(cut, calibration_));
      ASSERT_FALSE(got) << lane << " " << share;
      EXPECT_EQ(got.error().code, ErrorCode::usage) << lane << " " << share;
      EXPECT_NE(got.error().text.find("cut short or damaged: it has "), std::string::npos) << got.error().to_text();
    }
  }
}

TEST_F(Lanes, AnOptionThatALaneDoesNotHaveIsRefusedByName) {
  for (const char* lane : {"block", "tick", "uart"}) {
    const auto foreign = make_dut(lane, {{"foo", "1"}});
    ASSERT_FALSE(foreign) << lane;
    EXPECT_EQ(foreign.error().code, ErrorCode::usage);
    EXPECT_EQ(foreign.error().text, std::string("the ") + lane + " lane has no option 'foo'");
    for (const char* time : {"abc", "-1", "nan", "5s"}) EXPECT_FALSE(make_dut(lane, {{"timeout_s", time}})) << lane << time;
    EXPECT_TRUE(make_dut(lane, {{"timeout_s", "5"}})) << lane;
  }
}

TEST_F(Lanes, AnEmulatorThatAbortsIsToldByWhatItSaidAndNotByItsRegisters) {
  const PrivateFolder folder = PrivateFolder::make().value();
  const std::filesystem::path fake = folder.path() / "qemu";
  std::ofstream(fake) << "#!/bin/sh\necho \"qemu: fatal: Lockup: can't escalate 3 to HardFault\" >&2\n"
                         "echo >&2\necho R00=00000000 >&2\necho 'FPSCR: 00000000' >&2\nkill -ABRT $$\n";
  std::filesystem::permissions(fake, std::filesystem::perms::owner_all);
  const auto dut = make_dut("block", {{"qemu", fake.string()}});
  const auto got = (*dut)->open(session_of(image("reference-m4f.block.elf"), calibration_));
  ASSERT_FALSE(got);
  EXPECT_NE(got.error().text.find("qemu: fatal: Lockup: can't escalate 3 to HardFault"), std::string::npos) << got.error().text;
  EXPECT_EQ(got.error().text.find("FPSCR"), std::string::npos) << got.error().text;
}

TEST_F(Lanes, ACalibrationOutOfRangeIsRefusedInEveryLane) {
  Calibration bad = calibration_;
  bad.q_scale = 0.0;
  for (const auto& [lane, file] : {std::pair{"native", "reference.native.so"},
                                   {"block", "reference-m4f.block.elf"},
                                   {"uart", "reference.uart.elf"}}) {
    const auto out = run(lane, image(file), bad, {});
    ASSERT_FALSE(out) << lane;
    EXPECT_EQ(out.error().code, ErrorCode::firmware) << lane;
  }
}

}  // namespace
}  // namespace forcegate::test
