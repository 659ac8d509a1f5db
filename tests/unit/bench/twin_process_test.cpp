// What the processes of the twins hold open and leave behind.

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "adapters/transport/child_process.h"
#include "rigs/emulated/twins/native_image.h"
#include "tests/support/folder_test.h"
#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

constexpr const char* kNative = FORCEGATE_BINARY_DIR "/firmware/reference.native.so";
constexpr const char* kUart = FORCEGATE_BINARY_DIR "/firmware/reference.uart.elf";

TEST(TwinProcess, AnImageHoldsNoLineOfItsBoardOpen) {
  int line[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, line), 0);
  const auto image = emulated::load_native_image(kNative);
  ASSERT_TRUE(image) << image.error().to_text();
  close(line[0]);
  pollfd end{line[1], POLLIN, 0};
  EXPECT_EQ(poll(&end, 1, 0), 1) << "the far end was closed, and nobody sees it";
  close(line[1]);
}

class TwinFolder : public FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    if (const char* before = std::getenv("TMPDIR")) before_ = before;
    setenv("TMPDIR", folder_.c_str(), 1);
  }
  void TearDown() override {
    before_.empty() ? unsetenv("TMPDIR") : setenv("TMPDIR", before_.c_str(), 1);
    FolderTest::TearDown();
  }
  std::string before_;
};

TEST_F(TwinFolder, IsEmptyWhenTheTwinsHaveEnded) {
  if (!find_program("qemu-system-arm") || !std::filesystem::exists(kUart)) GTEST_SKIP() << "needs qemu-system-arm and the cross-compiled image";
  {
    test::TwinBench b("twin_rtu.toml");
    test::TwinBench::ok(b.session->world().flash(kUart));
    EXPECT_FALSE(std::filesystem::is_empty(folder_));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

}  // namespace
}  // namespace forcegate
