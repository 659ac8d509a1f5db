#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::string kStored = FORCEGATE_SOURCE_DIR "/tests/data/report/result_format1.json";

TEST(ReportVerb, ShowsTheStoredDecisionFirstAndStillSucceeds) {
  const ProcessResult r = forcegate({"report", kStored});
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("REJECT  maxima: panel mean 27.3(3) %"));
  EXPECT_EQ(r.out.find('\x1b'), std::string::npos);
  EXPECT_THAT(forcegate({"report", kStored, "--color", "always"}).out, StartsWith("\x1b["));
}

TEST(ReportVerb, WritesOnePageFromAFileOrFromTheFolderOfARun) {
  TemporaryFolder folder;
  write_text(folder / "result.json", read_text(kStored));
  ASSERT_EQ(
      forcegate({"report", folder.path().string(), "--format", "html", "-o", folder / "a.html"}).exit_code,
      0);
  ASSERT_EQ(forcegate({"report", kStored, "--format", "html", "-o", folder / "b.html"}).exit_code, 0);
  const std::string page = read_text(folder / "a.html");
  EXPECT_THAT(page, StartsWith("<!DOCTYPE html>"));
  EXPECT_THAT(page, HasSubstr("REJECT</h1>"));
  EXPECT_EQ(page, read_text(folder / "b.html"));
}

TEST(ReportVerb, GivesTheStoredBytesBackAsJson) {
  TemporaryFolder folder;
  ASSERT_EQ(forcegate({"report", kStored, "--format", "json", "-o", folder / "r.json"}).exit_code, 0);
  EXPECT_EQ(read_text(folder / "r.json"), read_text(kStored));
  const auto answer = nlohmann::json::parse(forcegate({"report", kStored, "--json"}).out);
  EXPECT_EQ(answer["decision"], "REJECT");
}

TEST(ReportVerb, RefusesWhatIsNoResultAndSaysHowToMendIt) {
  TemporaryFolder folder;
  write_text(folder / "bad.json", "{\"format\": 99}");
  const ProcessResult future = forcegate({"report", folder / "bad.json"});
  EXPECT_EQ(future.exit_code, 2);
  EXPECT_THAT(future.err, HasSubstr("result format 99"));
  EXPECT_THAT(future.err, HasSubstr("help:"));
  EXPECT_EQ(forcegate({"report", folder / "missing.json"}).exit_code, 2);
  const ProcessResult typo = forcegate({"report", kStored, "--format", "htlm"});
  EXPECT_EQ(typo.exit_code, 2);
  EXPECT_THAT(typo.err, HasSubstr("html"));
}

}  // namespace
}  // namespace forcegate::test
