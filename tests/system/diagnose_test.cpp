// Whatever the answer, the last line of a diagnosis says what to do next.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

std::string last_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

class DiagnoseSaysWhatIsNext : public ::testing::TestWithParam<const char*> {};

TEST_P(DiagnoseSaysWhatIsNext, with_and_without_a_page) {
  const TemporaryFolder folder;
  const ProcessOptions there{.folder = folder.path()};
  const ProcessResult made = forcegate({"mystery", "--seed", "5", "--effect", GetParam(), "--minutes", "3", "try"}, there);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  for (const bool page : {false, true}) {
    std::vector<std::string> arguments = {"diagnose", "try"};
    if (page) arguments.insert(arguments.end(), {"--html", "try.html"});
    const ProcessResult r = forcegate(arguments, there);
    ASSERT_EQ(r.exit_code, 0) << r.err;
    EXPECT_THAT(last_line(r.out), ::testing::StartsWith("next: forcegate ")) << r.out;
  }
}

INSTANTIATE_TEST_SUITE_P(Answers, DiagnoseSaysWhatIsNext, ::testing::Values("none", "hysteresis", "foreign_telegraph"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace forcegate::test
