// The smallest league that can still catch a broken engine: hard floors, not figures.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

TEST(LeagueVerb, LeavesCleanCampaignsAloneAndNamesStrongEffects) {
  const ProcessResult clean =
      forcegate({"league", "--seed", "4711", "--only", "none", "--controls", "12", "--json", "--quiet"});
  ASSERT_EQ(clean.exit_code, 0) << clean.err;
  const auto controls = nlohmann::json::parse(clean.out);
  EXPECT_EQ(controls["false_claims_on_controls"]["n"], 12);
  EXPECT_LE(controls["false_claims_on_controls"]["k"], 1) << controls["matches"].dump(1).substr(0, 3000);
  EXPECT_EQ(controls["no_answer"]["k"], 0);

  const ProcessResult played =
      forcegate({"league", "--seed", "4711", "--only", "hysteresis,clipping,hum,contact_loss", "--each", "1",
                 "--json", "--quiet"});
  ASSERT_EQ(played.exit_code, 0) << played.err;
  const auto table = nlohmann::json::parse(played.out);
  EXPECT_EQ(table["strong"]["top1"]["n"], 4);
  EXPECT_GE(table["strong"]["top1"]["k"], 3) << played.out.substr(0, 3000);
  EXPECT_EQ(table["sensor_blamed_for_others"]["k"], 0);
  EXPECT_GE(table["strong"]["top1"]["k"], table["largest_correlation"]["strong"]["k"])
      << "no better than the largest residual correlation";
}

TEST(LeagueVerb, AnUnknownEffectIsAUsageError) {
  const ProcessResult r = forcegate({"league", "--only", "hysteresys"});
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.err, ::testing::HasSubstr("forcegate mystery --list"));
}

}  // namespace
}  // namespace forcegate::test
