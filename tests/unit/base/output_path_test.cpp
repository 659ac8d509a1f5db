#include "hil/base/output_path.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace forcegate {
namespace {

namespace fs = std::filesystem;

class OutputPath : public ::testing::Test {
 protected:
  OutputPath() { fs::create_directories(folder / "real"); }
  ~OutputPath() override { fs::remove_all(folder); }
  fs::path folder = fs::temp_directory_path() / ("forcegate_output_path_" + std::to_string(getpid()));
};

TEST_F(OutputPath, IsThePathItselfWhereThereIsNoLink) {
  EXPECT_EQ(*output_path(folder / "new/run"), folder / "new/run");
  EXPECT_EQ(*output_path(folder / "real"), folder / "real");
  EXPECT_EQ(*output_path("run"), "run");
}

TEST_F(OutputPath, IsWhatALinkLeadsTo) {
  std::ofstream(folder / "file") << "x";
  fs::create_symlink("real", folder / "to_folder");
  fs::create_symlink("to_folder", folder / "twice");
  fs::create_symlink("file", folder / "to_file");
  EXPECT_EQ(*output_path(folder / "to_folder"), fs::canonical(folder / "real"));
  EXPECT_EQ(*output_path(folder / "twice/"), fs::canonical(folder / "real"));
  EXPECT_EQ(*output_path(folder / "to_file"), fs::canonical(folder / "file"));
}

TEST_F(OutputPath, RefusesALinkThatLeadsNowhere) {
  fs::create_symlink("gone", folder / "dangling");
  fs::create_symlink("circle", folder / "circle");
  for (const char* name : {"dangling", "circle", "dangling/"}) {
    const auto got = output_path(folder / name);
    ASSERT_FALSE(got) << name;
    EXPECT_EQ(got.error().code, ErrorCode::usage);
    EXPECT_NE(got.error().text.find("leads nowhere"), std::string::npos);
    EXPECT_FALSE(got.error().hint.empty());
  }
}

TEST_F(OutputPath, LeavesAPipeOrTerminalAsItIs) {
  fs::create_symlink("/dev/null", folder / "null");
  EXPECT_EQ(*output_path(folder / "null"), folder / "null");
}

}  // namespace
}  // namespace forcegate
