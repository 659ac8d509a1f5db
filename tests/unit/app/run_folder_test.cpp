// Whose folder a run may take over.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "hil/app/gate/run_folder.h"
#include "tests/support/folder_test.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

class RunFolderTest : public FolderTest {};

// Who restarts a killed run at once is there before anybody has asked for the exit code of the killed one.
TEST_F(RunFolderTest, IsFreeAtOnceWhenTheRunThatFilledItWasKilled) {
  const pid_t child = fork();
  if (child == 0) {
    pause();
    _exit(0);
  }
  const fs::path run = folder_ / "run";
  fs::create_directory(run.string() + ".part-" + std::to_string(child));
  const auto busy = RunFolder::open(run);
  ASSERT_FALSE(busy);
  EXPECT_THAT(busy.error().text, HasSubstr("another run is writing there now"));
  kill(child, SIGKILL);
  siginfo_t dead{};
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(child), &dead, WEXITED | WNOWAIT), 0);
  EXPECT_TRUE(RunFolder::open(run));
  waitpid(child, nullptr, 0);
}

// What it is called before it is whole is longer than its name.
TEST_F(RunFolderTest, ANameThatLeavesNoRoomForThatIsToldByItsLength) {
  const auto refused = RunFolder::open(folder_ / std::string(240, 'a'));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_THAT(refused.error().text, HasSubstr("too long: 240 bytes, and 234 are left for it"));
  EXPECT_TRUE(RunFolder::open(folder_ / std::string(234, 'a')));
}

}  // namespace
}  // namespace forcegate::test
