// An answer that a page prints is the one that the program gives.

#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

std::string words_of(const std::string& text) {
  std::istringstream in(text);
  std::string out;
  for (std::string word; in >> word;) out += (out.empty() ? "" : " ") + word;
  return out;
}

// The indented block behind the line that ends with `marker`.
std::string block_behind(const std::string& page, const std::string& marker) {
  std::istringstream in(page);
  std::string out;
  bool is_behind = false;
  for (std::string line; std::getline(in, line);) {
    if (is_behind && line.starts_with("    ")) out += line + "\n";
    else if (is_behind && !out.empty()) break;
    is_behind = is_behind || line.ends_with(marker);
  }
  return out;
}

TEST(PageExamples, TheAnswerOfTheDiagnosisPageIsTheProgramsOwn) {
  const std::string printed = block_behind(read_text(FORCEGATE_SOURCE_DIR "/docs/diagnosis.md"), "answers (long lines are wrapped here):");
  ASSERT_FALSE(printed.empty()) << "the page has no example any more";
  const TemporaryFolder folder;
  const ProcessOptions there{.folder = folder.path()};
  const ProcessResult made = forcegate({"mystery", "--seed", "13", "m13"}, there);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const ProcessResult answer = forcegate({"diagnose", "m13"}, there);
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(words_of(answer.out), words_of(printed)) << "docs/diagnosis.md prints what is no longer answered";
}

}  // namespace
}  // namespace forcegate::test
