// --map COLUMN=NAME:FACTOR:ZERO: a column in a scale of its own.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/trace/column_map.h"
#include "hil/trace/csv.h"

namespace forcegate {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

Result<TraceFile> read(const std::string& map) {
  const std::vector<std::string> words{map};
  auto columns = parse_column_map(words);
  if (!columns) return tl::unexpected(columns.error());
  return parse_csv("t_s,hx711,U_V\n0,84211,0.1\n1,105754,0.2\n2,62668,0.3\n", "x.csv", {*std::move(columns), 0.0});
}

TEST(MapScale, TakesTheReadingAtZeroOffAndMultiplies) {
  for (const char* map : {"hx711=F_ref_N:1/21543:84211", "hx711=F_ref_mN:1000/21543:84211"}) {
    const auto file = read(map);
    ASSERT_TRUE(file) << file.error().to_text();
    const Channel* F = file->trace.find("F_ref");
    ASSERT_NE(F, nullptr);
    EXPECT_EQ(F->unit, "N");
    EXPECT_NEAR(F->value[0], 0.0, 1e-9);
    EXPECT_NEAR(F->value[1], 1.0, 1e-9);
    EXPECT_NEAR(F->value[2], -1.0, 1e-9);
    EXPECT_THAT(file->notes, Contains(HasSubstr("column \"hx711\" was read as")));
  }
}

TEST(MapScale, NeedsNoZero) {
  const auto file = read("hx711=F_ref_N:1e-3");
  ASSERT_TRUE(file);
  EXPECT_NEAR(file->trace.find("F_ref")->value[0], 84.211, 1e-12);
}

TEST(MapScale, OverridesTheUnitOfTheHeader) {
  const std::vector<std::string> words{"load_counts=F_ref_N:0.5"};
  const auto file = parse_csv("t_s,load_counts,U_V\n0,10,0.1\n1,20,0.2\n", "x.csv", {*parse_column_map(words), 0.0});
  ASSERT_TRUE(file);
  EXPECT_EQ(file->trace.find("F_ref")->unit, "N");
  EXPECT_EQ(file->trace.find("F_ref")->value[1], 10.0);
}

TEST(MapScale, WhatIsNoScaleIsRefusedWithAnExample) {
  for (const char* wrong : {"hx711=F_ref_N:", "hx711=F_ref_N:x", "hx711=F_ref_N:0", "hx711=F_ref_N:1/0", "hx711=F_ref_N:1:", "hx711=F_ref_N:1:2:3", "hx711=F_ref_N:inf", "hx711=:1"}) {
    const auto file = read(wrong);
    ASSERT_FALSE(file) << wrong;
    EXPECT_THAT(file.error().hint, HasSubstr("F_ref_N:1/21543:84211")) << wrong;
  }
  EXPECT_THAT(read("hx711=weight_of:2").error().text, HasSubstr("names no unit"));
}

TEST(MapScale, CountsOfALoadCellLeadToIt) {
  const auto file = parse_csv("t_s,hx711,U_V\n0,84211,0.1\n1,105754,0.2\n", "x.csv");
  ASSERT_TRUE(file);
  EXPECT_THAT(column_map_advice(file->trace, "F_ref", "N"), HasSubstr("--map hx711=F_ref_N:FACTOR:ZERO"));
}

}  // namespace
}  // namespace forcegate
