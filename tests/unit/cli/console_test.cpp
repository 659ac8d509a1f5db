#include "hil/cli/console.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <limits>
#include <thread>
#include <vector>

namespace forcegate {
namespace {

using ::testing::HasSubstr;

class ConsoleTest : public ::testing::Test {
 protected:
  ~ConsoleTest() override {
    std::fclose(out_);
    std::fclose(err_);
  }
  static std::string text(std::FILE* file) {
    std::fflush(file);
    std::string all(static_cast<std::size_t>(std::ftell(file)), '\0');
    std::rewind(file);
    all.resize(std::fread(all.data(), 1, all.size(), file));
    return all;
  }
  std::FILE* out_ = std::tmpfile();
  std::FILE* err_ = std::tmpfile();
};

TEST_F(ConsoleTest, ProgressInALogIsALineEveryTenPercent) {
  {
    Console console({}, out_, err_);
    for (int i = 0; i <= 1000; ++i) console.progress(i / 1000.0, "case 1");
  }
  const std::string lines = text(err_);
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 10);
  EXPECT_THAT(lines, HasSubstr(" 50 %  case 1\n"));
  EXPECT_THAT(lines, HasSubstr("100 %  case 1\n"));
  EXPECT_EQ(lines.find('\r'), std::string::npos);
  EXPECT_EQ(text(out_), "") << "stdout is for results";
}

TEST_F(ConsoleTest, QuietMeansNoProgressNoNotesNoNextButTheResult) {
  Console console({.quiet = true}, out_, err_);
  console.progress(1.0, "x");
  console.note("n");
  console.next("do");
  console.print("result");
  EXPECT_EQ(text(err_), "");
  EXPECT_EQ(text(out_), "result\n");
}

TEST_F(ConsoleTest, WhatIsHandedOnStandsInAFileAtOnce) {
  Console console({}, out_, err_);
  console.print("commitment");
  console.flush();
  char first = 0;
  EXPECT_EQ(::pread(::fileno(out_), &first, 1, 0), 1);
  EXPECT_EQ(first, 'c');
}

TEST_F(ConsoleTest, WhatAFullDiskDidNotTakeIsToldOnStderr) {
  for (const std::size_t length : {std::size_t{10}, std::size_t{100000}}) {
    std::FILE* full = std::fopen("/dev/full", "w");
    ASSERT_NE(full, nullptr);
    std::FILE* err = std::tmpfile();
    {
      Console console({.json = true}, full, err);
      EXPECT_TRUE(console.all_written());
      console.print_json(std::string(length, '0'));
      EXPECT_FALSE(console.all_written()) << length;
      console.error({ErrorCode::io, "cannot write to standard output", "forcegate", "is the disk full?"});
    }
    EXPECT_THAT(text(err), HasSubstr("cannot write to standard output"));
    std::fclose(err);
    std::fclose(full);
  }
}

TEST_F(ConsoleTest, AReaderThatHasLeftIsNoFullDisk) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ::close(ends[0]);
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  std::FILE* out = ::fdopen(ends[1], "w");
  {
    Console console({}, out, err_);
    console.print(std::string(100000, 'x'));
    EXPECT_TRUE(console.all_written());
  }
  std::fclose(out);
  std::signal(SIGPIPE, before);
}

TEST_F(ConsoleTest, JsonAloneIsOnStdoutWhenAsked) {
  Console console({.json = true}, out_, err_);
  console.print("text");
  console.next("do");
  console.print_json("{}");
  EXPECT_EQ(text(out_), "{}\n");
}

TEST_F(ConsoleTest, TextsOfDevicesAreFilteredInErrors) {
  Console console({}, out_, err_);
  console.error({ErrorCode::device, "it said \x1b[31m\x07", "motor", "look"});
  EXPECT_EQ(text(err_).find('\x1b'), std::string::npos);
}

TEST_F(ConsoleTest, NonsenseFractionsAndManyThreadsDoNoHarm) {
  Console console({}, out_, err_);
  std::vector<std::jthread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (const double f : {-1.0, 0.5, 2.0, std::numeric_limits<double>::quiet_NaN()})
        console.progress(f, "x\ny\xff");
      console.print("line");
    });
  threads.clear();
  EXPECT_EQ(text(out_), "line\nline\nline\nline\n");
}

}  // namespace
}  // namespace forcegate
