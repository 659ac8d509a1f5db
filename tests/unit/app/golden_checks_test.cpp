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

TEST(GoldenChecks, ATubeThatHoldsNextToAnythingIsRemarked) {
  GoldenTarget t = target(0, "q50", true);
  t.truth_tube = {.absolute = 0.08, .time_s = 0.01};
  t.content.windows = {{0.0, 0.1, {1.0F, 2.0F}, {1.0F, 2.0F}}};
  GoldenRecord g;
  g.case_name = "sine", g.specimen = "q50";
  g.content = t.content;
  g.ati = t.truth_tube, g.firmware = t.firmware_tube;
  std::vector<std::string> notes;
  golden_checks({t}, {g}, notes);
  EXPECT_TRUE(notes.empty()) << notes.front();
  g.ati.absolute = 1e9;
  golden_checks({t}, {g}, notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes.front().find("the golden of sine/q50 holds next to nothing: tolerance ati absolute 1e+09"), std::string::npos) << notes.front();
  EXPECT_NE(notes.front().find("0.08"), std::string::npos) << notes.front();
}

}  // namespace
}  // namespace forcegate
