// The bench on the table as far as it needs no instrument.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "hil/interface/bench_world.h"
#include "hil/rig/config.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

class RealWorld : public FolderTest {
 protected:
  Result<void> flash(const std::string& list, const std::string& image) {
    const auto root = parse_config("[board]\nflash = " + list + "\n", put("bench.toml", "").string());
    EXPECT_TRUE(root);
    auto world = Registry<BenchWorldKind>::instance().find("real")->make(*root, {});
    EXPECT_TRUE(world);
    return (*world)->flash(image);
  }
};

TEST_F(RealWorld, FlashesWithAProgramBesideTheBenchFileThatFindsItsFilesThere) {
  const auto program = put("flash.sh", "#!/bin/sh\ncat board.cfg > flashed && echo \"$1\" >> flashed\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  put("board.cfg", "a board\n");
  const auto done = flash(R"(["./flash.sh", "program {image} verify"])", "/tmp/image.elf");
  ASSERT_TRUE(done) << done.error().to_text();
  std::ifstream flashed(folder_ / "flashed");
  const std::string text{std::istreambuf_iterator<char>(flashed), {}};
  EXPECT_EQ(text, "a board\nprogram /tmp/image.elf verify\n");
}

TEST_F(RealWorld, SaysHowToTryAFlashThatFailedByHand) {
  const auto done = flash(R"(["/bin/sh", "-c", "echo no target; exit 3"])", "/tmp/image.elf");
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::device);
  EXPECT_NE(done.error().text.find("exit code 3: no target"), std::string::npos) << done.error().to_text();
  EXPECT_NE(done.error().hint.find("by hand"), std::string::npos) << done.error().to_text();
}

}  // namespace
}  // namespace forcegate
