// One command fills a folder at a time, and who dies blocks nobody.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "hil/app/files/claimed_folder.h"
#include "tests/support/folder_test.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

class ClaimedFolderTest : public FolderTest {};

TEST_F(ClaimedFolderTest, IsRefusedToTheSecondUntilTheFirstIsDone) {
  const fs::path folder = folder_ / "a" / "b";
  {
    const auto first = ClaimedFolder::take(folder);
    ASSERT_TRUE(first);
    EXPECT_TRUE(first->is_new());
    const auto second = ClaimedFolder::take(folder);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, ErrorCode::usage);
    EXPECT_EQ(second.error().where, folder.string());
    EXPECT_THAT(second.error().text, HasSubstr("another run is writing there now"));
    EXPECT_THAT(second.error().hint, HasSubstr("another folder with -o"));
    EXPECT_TRUE(fs::exists(folder)) << "who was refused takes nothing away";
    std::ofstream(folder / "file") << "x";
  }
  const auto third = ClaimedFolder::take(folder);
  ASSERT_TRUE(third);
  EXPECT_FALSE(third->is_new());
}

TEST_F(ClaimedFolderTest, LeavesNoEmptyFolderThatItMade) {
  ASSERT_TRUE(ClaimedFolder::take(folder_ / "a" / "b"));
  EXPECT_FALSE(fs::exists(folder_ / "a"));
  fs::create_directory(folder_ / "own");
  ASSERT_TRUE(ClaimedFolder::take(folder_ / "own"));
  EXPECT_TRUE(fs::exists(folder_ / "own"));
  ASSERT_TRUE(ClaimedFolder::take({}));
}

TEST_F(ClaimedFolderTest, LeavesALinkThatLeadsNowhere) {
  fs::create_symlink("nowhere", folder_ / "link");
  for (const fs::path& path : {folder_ / "link", folder_ / "link" / "below"}) {
    EXPECT_FALSE(ClaimedFolder::take(path));
    EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  }
}

TEST_F(ClaimedFolderTest, IsFreeOnceItsHolderWasKilled) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const auto claim = ClaimedFolder::take(folder_ / "a");
    const char byte = claim ? 'y' : 'n';
    (void)!write(ready[1], &byte, 1);
    pause();
    _exit(0);
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  ASSERT_EQ(byte, 'y');
  EXPECT_FALSE(ClaimedFolder::take(folder_ / "a"));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(ClaimedFolder::take(folder_ / "a"));
  close(ready[0]), close(ready[1]);
}

}  // namespace
}  // namespace forcegate::test
