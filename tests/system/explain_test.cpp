// Every check of a report can be asked for.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

const ProcessOptions kHere{.folder = FORCEGATE_SOURCE_DIR, .timeout = std::chrono::minutes(10)};

std::set<std::string> checks_of(std::vector<std::string> gate, const std::string& run) {
  gate.insert(gate.begin(), "gate");
  gate.insert(gate.end(), {"-o", run});
  const ProcessResult r = forcegate(gate, kHere);
  EXPECT_EQ(r.exit_code, 0) << r.out << r.err;
  const auto result = nlohmann::json::parse(read_text(run + "/result.json"));
  std::set<std::string> out;
  const auto take = [&](const nlohmann::json& checks) {
    for (const auto& check : checks) out.insert(check["id"].get<std::string>());
  };
  take(result["checks"]);
  for (const auto& one : result["cases"]) take(one["checks"]);
  return out;
}

class ExplainedChecks : public testing::Test {
 protected:
  void expect_explained(const std::set<std::string>& checks) {
    EXPECT_GT(checks.size(), 5U);
    for (const std::string& id : checks) {
      const ProcessResult r = forcegate({"explain", id}, kHere);
      EXPECT_EQ(r.exit_code, 0) << id << ": " << r.err;
      EXPECT_THAT(r.out, testing::HasSubstr("(check)")) << id;
    }
  }
  TemporaryFolder folder_;
};

TEST_F(ExplainedChecks, AreAllThoseOfTheSmokePlan) {
  expect_explained(checks_of({FORCEGATE_BINARY_DIR "/firmware/reference-m4f.block.elf"}, folder_ / "run"));
}

TEST_F(ExplainedChecks, AreAllThoseOfTheGateOfConductanceAndCapacitance) {
  const std::string image = FORCEGATE_BINARY_DIR "/firmware/two-variable.native.so";
  expect_explained(checks_of({image, "--plan", "capacitance-gate", "--golden", FORCEGATE_SOURCE_DIR "/golden/traces/capacitance-gate",
                              "--accepted", image},
                             folder_ / "run"));
}

TEST(ExplainedWords, BesideTheNumbersOfAReportAndThoseOfFormsAreKnown) {
  for (const char* word : {"floor", "adapted", "refitted", "as written", "explainable", "likeness", "odds", "held-out", "%GRR", "ratio", "residual", "rival"}) {
    const ProcessResult r = forcegate({"explain", word}, kHere);
    EXPECT_EQ(r.exit_code, 0) << word << ": " << r.err;
    EXPECT_THAT(r.out, testing::HasSubstr("(figure)")) << word;
  }
  for (const auto& [form, effect] : {std::pair{"play_bank_curved", "hysteresis"}, {"power_law_decayed", "creep"}}) {
    const ProcessResult r = forcegate({"explain", form}, kHere);
    EXPECT_EQ(r.exit_code, 0) << form << ": " << r.err;
    EXPECT_THAT(r.out, testing::AllOf(testing::HasSubstr("(form)"), testing::HasSubstr(effect))) << form;
  }
}

TEST(ExplainedWords, WithoutAWordAreThoseOfEveryKind) {
  const auto terms = nlohmann::json::parse(forcegate({"explain", "--json"}, kHere).out)["terms"];
  std::set<std::string> kinds, words;
  for (const auto& term : terms) kinds.insert(term["kind"].get<std::string>()), words.insert(term["term"].get<std::string>());
  for (const char* kind : {"decision", "verdict", "exit code", "check", "effect", "figure"}) EXPECT_TRUE(kinds.contains(kind)) << kind;
  for (const char* word : {"NO-DECISION", "mre_maxima", "creep"}) EXPECT_TRUE(words.contains(word)) << word;
}

}  // namespace
}  // namespace forcegate::test
