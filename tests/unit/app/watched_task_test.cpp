#include "hil/app/play/watched_task.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <thread>

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
    const pid_t child = getpid();
    if (fork() == 0) {
      kill(child, SIGTERM);
      _exit(0);
    }
    pause();
    return std::string();
  });
  EXPECT_EQ(stopped.error().code, ErrorCode::cancelled);
}

TEST(WatchedTask, a_signal_that_the_image_sends_itself_is_its_own) {
  for (const int signal : {SIGTERM, SIGUSR1}) {
    const auto inside = in_child([signal]() -> Result<std::string> {
      const InFirmware marker(3);
      std::raise(signal);
      return std::string();
    });
    EXPECT_EQ(inside.error().code, ErrorCode::firmware) << signal;
    const auto later = in_child([signal]() -> Result<std::string> {
      { const InFirmware marker(3); }
      std::raise(signal);  // as by a handler or a timer of the image
      return std::string();
    });
    EXPECT_EQ(later.error().code, ErrorCode::firmware) << signal;
  }
}

TEST(WatchedTask, a_thread_of_the_image_crashes_for_the_image_and_only_where_there_is_one) {
  const auto with = [](bool image) {
    return in_child([image]() -> Result<std::string> {
      if (image) const InFirmware marker(0);
      std::thread other([] { std::raise(SIGSEGV); });
      other.join();
      return std::string();
    });
  };
  EXPECT_EQ(with(true).error().code, ErrorCode::firmware);
  EXPECT_NE(with(true).error().text.find("thread"), std::string::npos) << with(true).error().text;
  EXPECT_EQ(with(false).error().code, ErrorCode::internal);
}

TEST(WatchedTask, says_in_which_call_the_image_crashed) {
  const auto text = [](auto... arguments) {
    return in_child([=]() -> Result<std::string> {
             const InFirmware marker(arguments...);
             std::raise(SIGSEGV);
             return std::string();
           })
        .error()
        .text;
  };
  EXPECT_NE(text(FirmwareStage::opening).find("while it was opened"), std::string::npos);
  EXPECT_NE(text(FirmwareStage::closing).find("while it was closed"), std::string::npos);
  EXPECT_NE(text(4090U, 4090U).find("in the block of samples 4090 to 8179"), std::string::npos) << text(4090U, 4090U);
}

TEST(WatchedTask, an_image_that_hung_is_not_begun_again) {
  std::vector<WatchedTask> tasks;
  for (const char* image : {"hangs", "hangs", "good", "hangs", "good"})
    tasks.push_back({image,
                     [image](const auto&) -> Result<std::string> {
                       if (image != std::string("hangs")) return std::string("text");
                       const InFirmware marker(0);
                       for (volatile bool forever = true; forever;) {
                       }
                       return std::string();
                     },
                     image});
  WorkerOptions options;
  options.workers = 1;
  options.hang_cpu_s = 0.2;
  std::vector<std::size_t> left_out;
  WorkerEvents events;
  events.given_up = [&](std::size_t task) { left_out.push_back(task); };
  const auto answers = run_watched(tasks, options, events);
  EXPECT_EQ(left_out, (std::vector<std::size_t>{1, 3}));
  EXPECT_EQ(answers[2].value_or(""), "text");
  EXPECT_EQ(answers[4].value_or(""), "text");
  EXPECT_NE(answers[1].error().text.find("not played"), std::string::npos);
}

TEST(WatchedTask, an_image_that_leaves_a_process_is_told_at_once_and_the_process_ends) {
  int alive[2];  // the process that is left holds the writing end
  ASSERT_EQ(pipe(alive), 0);
  const auto begin = std::chrono::steady_clock::now();
  const auto left = in_child([&]() -> Result<std::string> {
    const InFirmware marker(0);
    if (fork() == 0) {
      sleep(60);
      _exit(0);
    }
    return std::string("good");
  });
  ASSERT_FALSE(left.has_value());
  EXPECT_EQ(left.error().code, ErrorCode::firmware);
  EXPECT_NE(left.error().text.find("leaves a process"), std::string::npos) << left.error().text;
  close(alive[1]);
  char byte = 0;
  EXPECT_EQ(read(alive[0], &byte, 1), 0) << "it has ended";
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
  close(alive[0]);
}

TEST(WatchedTask, a_process_that_an_image_splits_off_gives_no_answer_of_its_own) {
  const auto twice = in_child([]() -> Result<std::string> {
    const InFirmware marker(0);
    fork();
    return std::string("good");
  });
  ASSERT_FALSE(twice.has_value());
  EXPECT_NE(twice.error().text.find("leaves a process"), std::string::npos) << twice.error().text;
}

TEST(WatchedTask, an_image_that_closes_files_which_are_not_its_own_is_told_so) {
  for (const bool reopened : {false, true}) {
    const auto closed = in_child([reopened]() -> Result<std::string> {
      const InFirmware marker(0);
      for (int descriptor = 0; descriptor < 100; ++descriptor) close(descriptor);
      for (int k = 0; reopened && k < 100; ++k)
        if (open("/dev/null", O_RDWR) < 0) break;
      return std::string("good");
    });
    ASSERT_FALSE(closed.has_value());
    EXPECT_EQ(closed.error().code, ErrorCode::firmware) << closed.error().text;
    EXPECT_NE(closed.error().text.find("closed a file"), std::string::npos) << closed.error().text;
  }
  const auto loops = in_child([]() -> Result<std::string> {
    const InFirmware marker(0);
    for (int descriptor = 0; descriptor < 100; ++descriptor) close(descriptor);
    for (volatile bool forever = true; forever;) {
    }
    return std::string();
  });
  EXPECT_NE(loops.error().text.find("does not return"), std::string::npos) << loops.error().text;
}

TEST(WatchedTask, an_image_that_waits_is_ended_without_using_time) {
  WorkerOptions options;
  options.blocked_s = 0.3;
  const auto blocked = run_watched({{"task", [](const auto&) -> Result<std::string> {
                                       const InFirmware marker(0);
                                       pause();
                                       return std::string();
                                     }}},
                                   options);
  EXPECT_EQ(blocked.front().error().code, ErrorCode::firmware);
  EXPECT_NE(blocked.front().error().text.find("blocked"), std::string::npos);
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
