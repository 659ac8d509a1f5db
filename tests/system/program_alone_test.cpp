// The program where nothing of its tree lies beside it: no plans, no images.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

class ProgramAlone : public ::testing::Test {
 protected:
  ProgramAlone() { fs::copy_file(FORCEGATE_BINARY_DIR "/forcegate", folder / "forcegate"); }
  ProcessResult run(std::vector<std::string> words) {
    words.insert(words.begin(), folder / "forcegate");
    return run_process(words, {.folder = folder.path()});
  }
  TemporaryFolder folder;
};

TEST_F(ProgramAlone, NamesThePlanAndTheBenchInItsNextCommand) {
  write_text(folder / "mine.toml", "format = 1\nname = \"mine\"\n[panel]\nspecimens = [\"q50\"]\n[calibration]\nlevel = \"nominal\"\n[[case]]\nname = \"sine\"\nchecks = [\"conformance\"]\n"
                                   "stimulus = { name = \"sine\", f_Hz = 0.5, A_N = 1, m_N = 2, duration_s = 60 }\n");
  const ProcessResult plan = run({"plan", "mine.toml"});
  EXPECT_EQ(plan.exit_code, 0) << plan.err;
  EXPECT_THAT(plan.out, HasSubstr("forcegate gate FIRMWARE --plan mine.toml\n"));
  fs::copy_file(FORCEGATE_SOURCE_DIR "/rigs/twin.toml", folder / "twin.toml");
  const ProcessResult bench = run({"bench", "doctor", "twin.toml"});
  EXPECT_EQ(bench.exit_code, 0) << bench.out << bench.err;
  EXPECT_THAT(bench.out, HasSubstr("forcegate gate FIRMWARE --rig twin.toml --plan PLAN\n"));
}

TEST_F(ProgramAlone, TakesTheFileOfThePlanReplayWhereItHasNone) {
  fs::copy_file(FORCEGATE_SOURCE_DIR "/ci/plans/replay.toml", folder / "replay.toml");
  std::vector<std::string> words{"limits", FORCEGATE_BINARY_DIR "/firmware/reference.native.so"};
  for (int k = 0; k < 5; ++k) words.insert(words.end(), {"--record", std::to_string(k) + ".csv"});
  const ProcessResult without = run(words);
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_THAT(without.err, HasSubstr("there is no plan 'replay'"));
  words.insert(words.end(), {"--plan", "replay.toml"});
  const ProcessResult with = run(words);
  EXPECT_EQ(with.exit_code, 2);
  EXPECT_THAT(with.err, HasSubstr("0.csv")) << "the plan is found, and the recordings are missing";
}

}  // namespace
}  // namespace forcegate::test
