#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using Json = nlohmann::json;

const ProcessOptions kHere{.folder = FORCEGATE_SOURCE_DIR, .timeout = std::chrono::minutes(14)};

TEST(Power, EveryBadBuildIsRejectedAndEveryGoodOneAcceptedAndNoneOf59RunsOfTheReferenceIsRejected) {
  const ProcessResult r = forcegate(
      {"power", "--quick", "--seeds", "59", "--firmware", FORCEGATE_BINARY_DIR "/firmware", "--json"}, kHere);
  const Json table = Json::parse(r.out, nullptr, false);
  ASSERT_FALSE(table.is_discarded()) << r.out.substr(0, 400) << r.err;
  EXPECT_EQ(r.exit_code, 0) << r.err;
  std::size_t bad = 0, equivalent = 0;
  for (const Json& m : table["mutants"]) {
    ++(m["kind"] == "bad" ? bad : equivalent);
    const bool survives = m["expected"][0] == "nothing";
    EXPECT_TRUE(m["as_expected"].get<bool>() || survives) << m.dump();
    if (m["kind"] == "good") EXPECT_EQ(m["accepted"], m["runs"]) << m.dump();
    if (m["kind"] == "bad" && !survives) EXPECT_EQ(m["rejected"], m["runs"]) << m.dump();
  }
  EXPECT_GE(bad, 60U);
  EXPECT_GE(equivalent, 10U);
  EXPECT_EQ(table["slipped"]["k"], 0);
  EXPECT_EQ(table["reference"]["runs"], 59);
  EXPECT_EQ(table["reference"]["rejected"]["k"], 0) << table["reference"].dump();
}

}  // namespace
}  // namespace forcegate::test
