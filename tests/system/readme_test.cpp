// The README's mystery is played as it stands there: its seed must go on hiding what the text says and the engine go on finding it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

// Arguments of the README's lines "    build/forcegate VERB ...", from the first `mystery` to `reveal`.
std::vector<std::vector<std::string>> mystery_commands() {
  std::vector<std::vector<std::string>> out;
  std::istringstream readme(read_text(FORCEGATE_SOURCE_DIR "/README.md"));
  for (std::string line; std::getline(readme, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string word;
    if (!(words >> word) || word != "build/forcegate") continue;
    std::vector<std::string> arguments;
    while (words >> word) arguments.push_back(word);
    if (arguments.empty() || (out.empty() && arguments[0] != "mystery")) continue;
    out.push_back(arguments);
    if (arguments[0] == "reveal") break;
  }
  return out;
}

TEST(Readme, ItsMysteryIsSolvedByItsOwnCommands) {
  const TemporaryFolder folder;
  const ProcessOptions there{.folder = folder.path()};
  const auto commands = mystery_commands();
  ASSERT_GE(commands.size(), 5u);
  ASSERT_EQ(commands.back().front(), "reveal");
  const std::string effect = commands.back().back();
  for (const auto& arguments : commands) {
    SCOPED_TRACE(::testing::PrintToString(arguments));
    const ProcessResult r = forcegate(arguments, there);
    ASSERT_EQ(r.exit_code, 0) << r.err;
    if (arguments[0] == "diagnose") {
      EXPECT_THAT(r.out, ::testing::HasSubstr("* " + effect));
    }
    if (arguments[0] == "add") {
      EXPECT_EQ(arguments[1], effect);
      EXPECT_THAT(r.out, ::testing::Not(::testing::HasSubstr("did not fall")));
    }
    if (arguments[0] == "reveal") {
      EXPECT_THAT(r.out, ::testing::HasSubstr("Right: " + effect));
    }
  }
}

}  // namespace
}  // namespace forcegate::test
