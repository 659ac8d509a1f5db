// The workflow half of the diagnosis as a user runs it: record, add, export, build, gate.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;
namespace fs = std::filesystem;

const ProcessOptions kHere{.folder = FORCEGATE_SOURCE_DIR, .timeout = std::chrono::minutes(10)};

class Story : public ::testing::Test {
 protected:
  TemporaryFolder folder;
};

TEST_F(Story, TheGateRejectsTheOldBuildOnACreepingSensorAndAcceptsTheOneThatKnowsTheCreep) {
  const std::string out = folder / "story";
  const ProcessResult r = run_process({"/usr/bin/env", "FORCEGATE=" FORCEGATE_BINARY_DIR "/forcegate",
                                       "FIRMWARE=" FORCEGATE_BINARY_DIR "/firmware/reference.native.so",
                                       "FORCEGATE_STORY_FOLDER=" + out, "ci/story", "--short"},
                                      kHere);
  EXPECT_EQ(r.exit_code, 0) << r.out << r.err;
  const Json old_build = Json::parse(read_text(out + "/gate-old/result.json")),
             new_build = Json::parse(read_text(out + "/gate-new/result.json"));
  EXPECT_EQ(old_build["decision"]["kind"], "REJECT");
  EXPECT_THAT(old_build["decision"]["reason"].get<std::string>(), HasSubstr("minima"));
  EXPECT_EQ(new_build["decision"]["kind"], "ACCEPT");
  EXPECT_TRUE(fs::exists(out + "/pictures/ranking.svg"));
}

TEST_F(Story, ACampaignIsRecordedOnceAndNeverOverwritten) {
  const std::string mine = folder / "mine";
  const std::vector<std::string> record{"record", "--case", "levels", "--seed", "3", "-o", mine};
  const ProcessResult first = forcegate(record, kHere);
  EXPECT_EQ(first.exit_code, 0) << first.err;
  const Json list = Json::parse(read_text(mine + "/campaign.json"));
  ASSERT_EQ(list["records"].size(), 1u);
  EXPECT_EQ(list["records"][0]["kind"], "staircase");
  const ProcessResult again = forcegate(record, kHere);
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("there is a campaign already"));
}

TEST_F(Story, AnEffectThatNoFirmwareCanUndoIsRefusedWithItsReason) {
  const std::string model = folder / "m.toml";
  write_text(
      model,
      "format = 1\n[law]\nkind = \"decaying\"\n[[effect]]\nname = \"delay\"\nstrength.c = { value = 1.0 }\n");
  const ProcessResult r = forcegate({"export", model, "--c", folder / "comp.h"}, kHere);
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.err, HasSubstr("needs the future"));
  EXPECT_FALSE(fs::exists(fs::path(folder / "comp.h")));
}

TEST_F(Story, LawsNamesTheMissingDependence) {
  const std::string table = folder / "table.csv";
  std::string text = "f_Hz,A_N,b\n";
  for (int i = 0; i < 16; ++i) {
    const double f = 0.1 + 0.25 * i, A = 0.5 + 0.3 * ((i * 7) % 5), noise = 0.0001 * ((i * 5) % 7 - 3);
    text += std::to_string(f) + "," + std::to_string(A) + "," + std::to_string(0.0056 + 0.0019 * f + noise) +
            "\n";
  }
  write_text(table, text);
  const ProcessResult r = forcegate({"laws", table, "--of", "b"}, kHere);
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("the law of b lacks f"));
}

}  // namespace
}  // namespace forcegate::test
