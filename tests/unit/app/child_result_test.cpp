#include "hil/app/child_result.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

#include "hil/interface/firmware_guard.h"

namespace forcegate::test {
namespace {

constexpr double kCpu_s = 1.0, kWall_s = 20.0;

TEST(ChildResult, gives_the_text_and_the_errors_of_the_work) {
  const std::string large(3'000'000, 'x');
  EXPECT_EQ(run_in_child([&]() -> Result<std::string> { return large; }, kCpu_s, kWall_s).value_or(""), large);
  const auto failed = run_in_child([]() -> Result<std::string> { return fail(ErrorCode::usage, "text", "where", "hint"); }, kCpu_s, kWall_s);
  ASSERT_FALSE(failed.has_value());
  EXPECT_EQ(failed.error().code, ErrorCode::usage);
  EXPECT_EQ(failed.error().text + failed.error().where + failed.error().hint, "textwherehint");
}

TEST(ChildResult, charges_a_crash_to_the_image_only_when_it_was_inside) {
  const auto inside = run_in_child(
      []() -> Result<std::string> {
        const InFirmware marker(640);
        std::raise(SIGSEGV);
        return std::string();
      },
      kCpu_s, kWall_s);
  ASSERT_FALSE(inside.has_value());
  EXPECT_EQ(inside.error().code, ErrorCode::firmware);
  EXPECT_NE(inside.error().text.find("640"), std::string::npos) << inside.error().text;
  const auto outside = run_in_child(
      []() -> Result<std::string> {
        std::raise(SIGSEGV);
        return std::string();
      },
      kCpu_s, kWall_s);
  EXPECT_EQ(outside.error().code, ErrorCode::internal);
}

TEST(ChildResult, ends_an_image_that_does_not_come_back_or_ends_its_process) {
  const auto hang = run_in_child(
      []() -> Result<std::string> {
        const InFirmware marker(0);
        volatile bool goes_on = true;
        while (goes_on) {
        }
        return std::string();
      },
      kCpu_s, kWall_s);
  EXPECT_EQ(hang.error().code, ErrorCode::firmware);
  EXPECT_NE(hang.error().text.find("does not come back"), std::string::npos);
  const auto gone = run_in_child(
      []() -> Result<std::string> {
        const InFirmware marker(0);
        _Exit(0);
      },
      kCpu_s, kWall_s);
  EXPECT_EQ(gone.error().code, ErrorCode::firmware);
}

}  // namespace
}  // namespace forcegate::test
