// The run before one that was killed.

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

#include "hil/app/gate/bundle.h"
#include "hil/app/gate/run_folder.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

namespace fs = std::filesystem;

using RunAside = FolderTest;

TEST_F(RunAside, is_named_and_has_its_name_again) {
  const fs::path run = folder_ / "run", aside = folder_ / "run.older-999999998";
  ASSERT_TRUE(RunFolder::open(run)->publish({}));
  fs::rename(run, aside);
  fs::create_directories(folder_ / "run.older-999999997");  // an earlier one
  std::ofstream(folder_ / "run.older-999999997" / "result.json") << "{}";
  fs::last_write_time(folder_ / "run.older-999999997" / "result.json", fs::file_time_type::clock::now() - std::chrono::hours(1));
  EXPECT_EQ(run_put_aside(run), aside);
  EXPECT_EQ(run_put_aside(run / ""), aside);
  EXPECT_EQ(run_put_aside(folder_ / "other"), fs::path());
  for (const Error& e : {read_bundle(run).error(), read_run(run).error()}) EXPECT_NE(e.hint.find(aside.string()), std::string::npos) << e.hint;
  {
    auto interrupted = RunFolder::open(run);
    ASSERT_TRUE(interrupted);
    EXPECT_EQ(interrupted->older(), aside);
    EXPECT_FALSE(fs::exists(run)) << "it must not be taken for this one";
  }
  EXPECT_TRUE(fs::exists(run / "result.json"));
  EXPECT_FALSE(fs::exists(aside));
}

}  // namespace
}  // namespace forcegate
