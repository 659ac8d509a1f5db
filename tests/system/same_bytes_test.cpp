// The same command with the same seed gives the same bytes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* kNative = FORCEGATE_BINARY_DIR "/firmware/reference.native.so";

ProcessResult gate(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "gate");
  return forcegate(arguments, {.folder = FORCEGATE_SOURCE_DIR, .timeout = std::chrono::minutes(10)});
}

TEST(SameBytes, TwoRunsOfOneSeedDifferOnlyInTheTimeStamp) {
  const TemporaryFolder folder;
  const std::vector<std::string> run = {kNative, "--seed", "11", "--quiet"};
  const auto with = [&](const std::string& threads) {
    auto arguments = run;
    arguments.insert(arguments.end(), {"--threads", threads, "-o", folder / "run"});
    const ProcessResult r = gate(std::move(arguments));
    EXPECT_EQ(r.exit_code, 0) << r.out << r.err;
    Json result = Json::parse(read_text(folder / "run/result.json"), nullptr, false);
    EXPECT_TRUE(result.contains("started_at"));
    result.erase("started_at");
    return result;
  };
  Json one = with("1");
  const Json again = with("1");
  EXPECT_EQ(one.dump(), again.dump());
  Json four = with("4");
  // The command line names the number of threads; nothing else may.
  one.erase("command_line");
  four.erase("command_line");
  EXPECT_EQ(one.dump(), four.dump());
}

TEST(SameBytes, TheKeptSamplesOfTwoRunsAreTheSameBytes) {
  const TemporaryFolder folder;
  std::map<std::string, std::string> before;
  for (const bool again : {false, true}) {
    const ProcessResult r = gate({kNative, "--specimen", "q50", "--case", "four_sines", "--keep", "-o", folder / "run"});
    EXPECT_EQ(r.exit_code, 0) << r.out << r.err;
    std::size_t traces = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder / "run")) {
      const std::string name = entry.path().lexically_relative(folder / "run").string();
      const bool trace = name.starts_with("traces/");
      if (!trace && name != "bundle/records.jsonl") continue;
      traces += trace;
      if (again)
        EXPECT_TRUE(before[name] == read_text(entry.path())) << name;
      else
        before[name] = read_text(entry.path());
    }
    EXPECT_EQ(traces, 1u);
  }
  EXPECT_THAT(before["bundle/records.jsonl"], ::testing::HasSubstr("\"keep\":\"traces/"));
}

}  // namespace
}  // namespace forcegate::test
