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
  for (const auto& entry : fs::directory_iterator(FORCEGATE_SOURCE_DIR "/rigs/firmware/two_variable/mutants")) {
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
