// The firmware that reads conductance and capacitance, gated as a user does it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

const fs::path kFirmware = FORCEGATE_BINARY_DIR "/firmware";
const ProcessOptions kHere{.folder = FORCEGATE_SOURCE_DIR, .timeout = std::chrono::minutes(10)};

ProcessResult gate(const fs::path& image, const fs::path& out) {
  return forcegate({"gate", image.string(), "--plan", "capacitance-gate", "-o", out.string()}, kHere);
}

TEST(TwoVariableFirmware, AStoredRunIsJudgedAgainByteForByteAndUnderOtherLimits) {
  const TemporaryFolder folder;
  const std::string run = (folder.path() / "run").string();
  ASSERT_EQ(gate(kFirmware / "two-variable.native.so", run).exit_code, 0);
  const ProcessResult same = forcegate({"check", run, "--replay"}, kHere);
  EXPECT_EQ(same.exit_code, 0) << same.out << same.err;
  EXPECT_THAT(same.out, HasSubstr("byte for byte"));
  EXPECT_THAT(same.out, HasSubstr("8 records played again"));
  std::string plan = read_text(FORCEGATE_SOURCE_DIR "/ci/plans/capacitance-gate.toml");
  plan.replace(plan.find("pack_mse_N2 = 0.515"), 19, "pack_mse_N2 = 0.010");
  write_text(folder.path() / "strict.toml", plan);
  write_text(folder.path() / "capacitance.toml",
             read_text(FORCEGATE_SOURCE_DIR "/ci/plans/capacitance.toml"));
  const ProcessResult strict =
      forcegate({"check", run, "--plan", (folder.path() / "strict.toml").string()}, kHere);
  EXPECT_EQ(strict.exit_code, 4) << "the network itself is beyond this limit: nobody's build\n" << strict.out;
  write_text(folder.path() / "run/bundle/records.jsonl", "");
  EXPECT_EQ(forcegate({"check", run}, kHere).exit_code, 2);
}

TEST(TwoVariableFirmware, IsPlayedAgainWithTheOptionsOfItsLane) {
  const TemporaryFolder folder;
  const std::string run = (folder.path() / "run").string(), own = (folder.path() / "own-qemu").string();
  fs::create_symlink("/usr/bin/qemu-system-arm", own);
  const ProcessResult gated = forcegate({"gate", (kFirmware / "two-variable.uart.elf").string(), "--plan", "capacitance-gate", "--case",
                                         "pack0-sensor1", "--lane-option", "qemu=" + own, "-o", run},
                                        kHere);
  ASSERT_EQ(gated.exit_code, 0) << gated.out << gated.err;
  EXPECT_EQ(forcegate({"check", run, "--replay"}, kHere).exit_code, 0);
  fs::remove(own);
  const ProcessResult without = forcegate({"check", run, "--replay"}, kHere);
  EXPECT_NE(without.exit_code, 0);
  EXPECT_THAT(without.out + without.err, HasSubstr("own-qemu is not installed"));
}

TEST(TwoVariableFirmware, IsHeldAgainstGoldensAndAnAcceptedBuild) {
  const TemporaryFolder folder;
  const std::string image = (kFirmware / "two-variable.native.so").string(),
                    run = (folder.path() / "run").string();
  const auto gated = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"gate", image, "--plan", "capacitance-gate", "-o", run};
    words.insert(words.end(), more.begin(), more.end());
    return forcegate(words, kHere);
  };
  const ProcessResult committed =
      gated({"--golden", FORCEGATE_SOURCE_DIR "/golden/traces/capacitance-gate", "--accepted", image});
  EXPECT_EQ(committed.exit_code, 0) << committed.out << committed.err;
  EXPECT_TRUE(fs::exists(fs::path(run) / "golden/pack0-sensor1@2010-0-1.csv"));
  EXPECT_EQ(forcegate({"check", run}, kHere).exit_code, 0);
  const std::string goldens = (folder.path() / "traces/own").string();
  EXPECT_EQ(gated({"--golden", goldens}).exit_code, 2) << "there is no such folder yet";
  fs::create_directories(goldens);
  const ProcessResult none = gated({"--golden", goldens});
  EXPECT_EQ(none.exit_code, 3) << none.out;
  const ProcessResult blessed =
      forcegate({"bless", run, "--who", "A. Smith", "--reason", "first", "--goldens", goldens}, kHere);
  EXPECT_EQ(blessed.exit_code, 0) << blessed.out << blessed.err;
  EXPECT_EQ(gated({"--golden", goldens}).exit_code, 0);
  // A golden whose firmware was elsewhere by 0.1 N.
  const fs::path golden = folder.path() / "traces/own/pack0-sensor1@2010-0-1.golden";
  std::string text = read_text(golden);
  text.erase(text.find("digest "), std::string("digest ").size() + 65);  // as older versions wrote it
  const std::size_t line = text.find("window"), row = text.find('\n', line) + 1, end = text.find('\n', row);
  const std::string first = text.substr(row, text.find(' ', row) - row);
  text.replace(row, end - row, first + " " + std::to_string(std::stod(first) + 0.1));
  write_text(golden, text);
  const ProcessResult left = gated({"--golden", goldens});
  EXPECT_EQ(left.exit_code, 1) << left.out;
  EXPECT_THAT(left.out, HasSubstr("golden"));
}

TEST(TwoVariableFirmware, AStoredRunUnderOtherWeightsIsNoComparison) {
  const TemporaryFolder folder;
  const std::string image = (kFirmware / "two-variable.native.so").string(), quiet = (folder.path() / "quiet").string(), run = (folder.path() / "run").string();
  const auto gated = [&](const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> words{"gate", image, "--plan", "capacitance-gate", "--case", "pack0-sensor1", "-o", out};
    words.insert(words.end(), more.begin(), more.end());
    return forcegate(words, kHere);
  };
  ASSERT_NE(gated(quiet, {"--rig-option", "noise=off"}).exit_code, 2);
  const ProcessResult other = gated(run, {"--accepted", quiet});
  EXPECT_EQ(other.exit_code, 2) << other.out;
  EXPECT_THAT(other.err, HasSubstr("other options of the rig: noise=off (here none)"));
  EXPECT_NE(gated(run, {"--accepted", quiet, "--rig-option", "noise=off"}).exit_code, 2);
}

TEST(TwoVariableFirmware, OptionsThatMeanNothingForItAreRefusedWithTheReason) {
  const TemporaryFolder folder;
  const std::string image = (kFirmware / "two-variable.native.so").string(),
                    run = (folder.path() / "run").string();
  for (const std::vector<std::string>& option :
       std::vector<std::vector<std::string>>{{"--limits", "x.toml"},
                                             {"--keep"},
                                             {"--fault", "reference_noise=1"},
                                             {"--specimen", "q50"},
                                             {"--seed", "5"},
                                             {"--record", "x.csv"},
                                             {"--calibration", "static"},
                                             {"--case", "pack0-sensor9"},
                                             {"--waivers", "none.toml"}}) {
    std::vector<std::string> words{"gate", image, "--plan", "capacitance-gate", "-o", run};
    words.insert(words.end(), option.begin(), option.end());
    const ProcessResult r = forcegate(words, kHere);
    EXPECT_EQ(r.exit_code, 2) << option[0] << r.out << r.err;
  }
  EXPECT_EQ(forcegate({"limits", image, "--plan", "capacitance-gate", "-o", run}, kHere).exit_code, 2);
  const ProcessResult estimate = forcegate({"plan", "capacitance-gate", "--estimate"}, kHere);
  EXPECT_EQ(estimate.exit_code, 0) << estimate.err;
  EXPECT_THAT(estimate.out, HasSubstr("8 sensors"));
  EXPECT_THAT(estimate.out, HasSubstr("13.7 h"));
}

TEST(TwoVariableFirmware, IsAcceptedNativelyAndOnACortexM) {
  const TemporaryFolder folder;
  for (const char* image : {"two-variable.native.so", "two-variable-m4f.block.elf"}) {
    const ProcessResult r = gate(kFirmware / image, folder.path() / "run");
    EXPECT_EQ(r.exit_code, 0) << image << r.out << r.err;
    const auto result = nlohmann::json::parse(read_text(folder.path() / "run/result.json"));
    EXPECT_EQ(result["cases"].size(), 8u);
    EXPECT_EQ(result["decision"]["kind"], "ACCEPT");
  }
}

TEST(TwoVariableFirmware, IsRejectedWithEachOfItsDefects) {
  const TemporaryFolder folder;
  int mutants = 0;
  for (const auto& entry :
       fs::directory_iterator(FORCEGATE_SOURCE_DIR "/rigs/firmware/two_variable/mutants")) {
    const fs::path image = kFirmware / "two-variable-mutants" / (entry.path().stem().string() + ".native.so");
    const ProcessResult r = gate(image, folder.path() / "run");
    EXPECT_EQ(r.exit_code, 1) << image << r.out << r.err;
    EXPECT_THAT(r.out, HasSubstr("REJECT"));
    ++mutants;
  }
  EXPECT_GE(mutants, 8);
}

TEST(TwoVariableFirmware, AnImageWithoutItsNetworksIsRefusedWithTheReason) {
  const TemporaryFolder folder;
  const ProcessResult r = gate(kFirmware / "reference.native.so", folder.path() / "run");
  EXPECT_EQ(r.exit_code, 1) << r.out << r.err;
  EXPECT_THAT(r.out, HasSubstr("40000 Hz"));
}

}  // namespace
}  // namespace forcegate::test
