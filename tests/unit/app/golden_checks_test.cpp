// Of which record a golden is missing.

#include "hil/app/gate/golden.h"

#include <gtest/gtest.h>

namespace forcegate {
namespace {

GoldenTarget target(std::size_t place, const std::string& specimen, bool to_bless) {
  GoldenTarget t;
  t.place = place;
  t.case_name = "sine";
  t.specimen = specimen;
  t.record_id = "sine/" + specimen;
  t.to_bless = to_bless;
  return t;
}

TEST(GoldenChecks, AMissingGoldenIsThatOfTheRecordThatWouldBeBlessed) {
  std::vector<std::string> notes;
  const ChecksByRecord checks = golden_checks({target(0, "q25", false), target(1, "q50", true)}, {}, notes);
  ASSERT_EQ(checks.size(), 1u);
  ASSERT_TRUE(checks.contains(1));
  const Check& lacks = checks.at(1).front().check;
  EXPECT_EQ(lacks.case_id, "sine/q50");
  EXPECT_EQ(lacks.verdict, Verdict::not_run);
  EXPECT_TRUE(lacks.required);
  // where only others are played, one of them says so
  EXPECT_TRUE(golden_checks({target(0, "q25", false)}, {}, notes).contains(0));
}

}  // namespace
}  // namespace forcegate
