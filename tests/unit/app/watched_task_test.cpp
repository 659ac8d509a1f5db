#include "hil/app/watched_task.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>

#include "hil/interface/firmware_guard.h"

namespace forcegate::test {
namespace {

Result<std::string> in_child(std::function<Result<std::string>()> work) {
  WorkerOptions options;
  options.hang_cpu_s = 1.0;
  return run_watched({{"task", [work = std::move(work)](const auto&) { return work(); }}}, options).front();
}

TEST(WatchedTask, gives_the_text_and_the_errors_of_the_work) {
  const std::string large(3'000'000, 'x');
  EXPECT_EQ(in_child([&]() -> Result<std::string> { return large; }).value_or(""), large);
  const auto failed =
      in_child([]() -> Result<std::string> { return fail(ErrorCode::usage, "text", "where", "hint"); });
  ASSERT_FALSE(failed.has_value());
  EXPECT_EQ(failed.error().code, ErrorCode::usage);
  EXPECT_EQ(failed.error().text + failed.error().where + failed.error().hint, "textwherehint");
}

TEST(WatchedTask, charges_a_crash_to_the_image_only_when_it_was_inside) {
  const auto inside = in_child([]() -> Result<std::string> {
    const InFirmware marker(640);
    std::raise(SIGSEGV);
    return std::string();
  });
  ASSERT_FALSE(inside.has_value());
  EXPECT_EQ(inside.error().code, ErrorCode::firmware);
  EXPECT_NE(inside.error().text.find("640"), std::string::npos) << inside.error().text;
  const auto outside = in_child([]() -> Result<std::string> {
    std::raise(SIGSEGV);
    return std::string();
  });
  EXPECT_EQ(outside.error().code, ErrorCode::internal);
}

TEST(WatchedTask, ends_an_image_that_does_not_come_back_or_ends_its_process) {
  const auto hang = in_child([]() -> Result<std::string> {
    const InFirmware marker(0);
    volatile bool goes_on = true;
    while (goes_on) {
    }
    return std::string();
  });
  EXPECT_EQ(hang.error().code, ErrorCode::firmware);
  EXPECT_NE(hang.error().text.find("does not return"), std::string::npos);
  const auto gone = in_child([]() -> Result<std::string> {
    const InFirmware marker(0);
    _Exit(0);
  });
  EXPECT_EQ(gone.error().code, ErrorCode::firmware);
}

TEST(WatchedTask, what_an_image_prints_or_reads_is_not_the_terminal_of_the_gate) {
  const auto seen = in_child([]() -> Result<std::string> {
    std::fputs("noise", stdout);
    std::fflush(stdout);
    return std::string(std::getchar() == EOF && isatty(STDOUT_FILENO) == 0 ? "nothing" : "something");
  });
  EXPECT_EQ(seen.value_or(""), "nothing");
}

TEST(WatchedTask, a_child_that_is_stopped_from_outside_says_nothing_about_the_image) {
  const auto stopped = in_child([]() -> Result<std::string> {
    const InFirmware marker(3);
    std::raise(SIGTERM);
    return std::string();
  });
  EXPECT_EQ(stopped.error().code, ErrorCode::cancelled);
}

TEST(WatchedTask, texts_come_back_in_the_order_of_the_tasks) {
  std::vector<WatchedTask> tasks;
  for (int i = 0; i < 7; ++i)
    tasks.push_back({std::to_string(i), [i](const auto&) -> Result<std::string> {
                       usleep(static_cast<useconds_t>((7 - i) * 2000));
                       return std::string(static_cast<std::size_t>(i), 'x');
                     }});
  WorkerOptions options;
  options.workers = 3;
  const auto texts = run_watched(tasks, options);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(texts[i].value_or("none").size(), i);
}

}  // namespace
}  // namespace forcegate::test
