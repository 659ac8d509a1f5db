#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using Json = nlohmann::json;

const ProcessOptions kHere{.folder = FORCEGATE_SOURCE_DIR, .timeout = std::chrono::minutes(14)};

TEST(Power, EveryBadBuildIsRejectedAndEveryGoodOneAcceptedAndNoneOf59RunsOfTheReferenceIsRejected) {
  const ProcessResult r = forcegate(
      {"power", "--quick", "--seeds", "59", "--firmware", FORCEGATE_BINARY_DIR "/firmware", "--json"}, kHere);
  const Json table = Json::parse(r.out, nullptr, false);
  ASSERT_FALSE(table.is_discarded()) << r.out.substr(0, 400) << r.err;
  EXPECT_EQ(r.exit_code, 0) << r.err;
  std::size_t bad = 0, equivalent = 0;
  for (const Json& m : table["mutants"]) {
    ++(m["kind"] == "bad" ? bad : equivalent);
    const bool survives = m["expected"][0] == "nothing";
    EXPECT_TRUE(m["as_expected"].get<bool>() || survives) << m.dump();
    if (m["kind"] == "good") {
      EXPECT_EQ(m["accepted"], m["runs"]) << m.dump();
    }
    if (m["kind"] == "bad" && !survives) {
      EXPECT_EQ(m["rejected"], m["runs"]) << m.dump();
    }
  }
  EXPECT_GE(bad, 60U);
  EXPECT_GE(equivalent, 10U);
  EXPECT_EQ(table["slipped"]["k"], 0);
  EXPECT_EQ(table["reference"]["runs"], 59);
  EXPECT_EQ(table["reference"]["rejected"]["k"], 0) << table["reference"].dump();
}

const std::string kFirmware = FORCEGATE_BINARY_DIR "/firmware/";
const std::vector<std::string> kOneCase{"--case", "sine_f0.50_A1.50_m2.70"};

ProcessResult gate(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "gate");
  arguments.insert(arguments.end(), kOneCase.begin(), kOneCase.end());
  return forcegate(arguments, kHere);
}

TEST(AcceptedBuild, TheSameCodeInAnotherLaneIsNoWorseAndTheComparisonIsInTheResult) {
  TemporaryFolder folder;
  const ProcessResult r = gate({kFirmware + "reference-m4f.block.elf", "--accepted",
                                kFirmware + "reference.native.so", "-o", folder / "run"});
  EXPECT_EQ(r.exit_code, 0) << r.out << r.err;
  const Json result = Json::parse(read_text(folder / "run/result.json"));
  std::size_t compared = 0;
  for (const Json& c : result["checks"])
    if (c["id"].get<std::string>().starts_with("no_worse_")) {
      ++compared;
      EXPECT_EQ(c["value"], 0.0) << c.dump();
      EXPECT_EQ(c["verdict"], "pass");
    }
  EXPECT_EQ(compared, 2U);
}

TEST(AcceptedBuild, AWorseBuildIsRejectedAgainstTheStoredRunOfTheAcceptedOne) {
  TemporaryFolder folder;
  ASSERT_EQ(gate({kFirmware + "reference.native.so", "-o", folder / "accepted"}).exit_code, 0);
  const ProcessResult r = gate({kFirmware + "mutants/compensation_off.native.so", "--accepted",
                                folder / "accepted", "-o", folder / "run"});
  EXPECT_EQ(r.exit_code, 1) << r.out;
  EXPECT_THAT(r.out, ::testing::HasSubstr("against the accepted build"));
}

TEST(AcceptedBuild, ARunOfAnotherSeedCannotBeComparedWith) {
  TemporaryFolder folder;
  ASSERT_EQ(gate({kFirmware + "reference.native.so", "-o", folder / "accepted"}).exit_code, 0);
  const ProcessResult r = gate({kFirmware + "reference.native.so", "--seed", "99", "--accepted",
                                folder / "accepted", "-o", folder / "run"});
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.err, ::testing::HasSubstr("seed"));
  const ProcessResult none =
      gate({kFirmware + "reference.native.so", "--accepted", "/nonexistent", "-o", folder / "x"});
  EXPECT_EQ(none.exit_code, 2);
}

}  // namespace
}  // namespace forcegate::test
