// A force that presses is positive, whatever the cell counts.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "hil/trace/campaign.h"
#include "hil/trace/column_map.h"
#include "hil/trace/compression.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class Compression : public FolderTest {
 protected:
  // A triangle between two forces, as often in every file.
  static std::string triangle(double from_N, double to_N) {
    std::string out = "t_s,F_ref_N,F_cmd_N,U_V\n";
    for (int i = 0; i < 400; ++i) {
      const double share = std::abs(i % 100 - 50) / 50.0, F = from_N + share * (to_N - from_N);
      out += std::to_string(0.01 * i) + "," + std::to_string(F) + "," + std::to_string(std::abs(F)) + "," + std::to_string(0.1 + std::abs(F)) + "\n";
    }
    return out;
  }
  static double first_N(const Campaign& campaign, std::size_t record = 0) { return campaign.records.at(record).trace.find("F_ref")->value.front(); }
};

TEST_F(Compression, OfACellThatCountsTensionIsTurnedOver) {
  const auto campaign = read_campaign(put("a.csv", triangle(-0.2, -5.0)));
  ASSERT_TRUE(campaign) << campaign.error().to_text();
  EXPECT_DOUBLE_EQ(first_N(*campaign), 5.0);
  EXPECT_DOUBLE_EQ(campaign->records[0].trace.find("F_cmd")->value.front(), 5.0) << "it was above zero";
  EXPECT_THAT(campaign->notes, Contains(HasSubstr("F_ref lies below zero (-4.")));
  EXPECT_THAT(campaign->notes, Not(Contains(HasSubstr("F_cmd lies"))));
}

TEST_F(Compression, AZeroThatIsOffBySomePercentIsNoPull) {
  const auto campaign = read_campaign(put("a.csv", triangle(0.1, -5.0)));
  ASSERT_TRUE(campaign);
  EXPECT_DOUBLE_EQ(first_N(*campaign), 5.0);
}

TEST_F(Compression, WhatGoesBothWaysStays) {
  const auto campaign = read_campaign(put("a.csv", triangle(1.0, -5.0)));
  ASSERT_TRUE(campaign);
  EXPECT_DOUBLE_EQ(first_N(*campaign), -5.0);
  EXPECT_THAT(campaign->notes, Not(Contains(HasSubstr("turned over"))));
}

TEST_F(Compression, AllRecordsAgreeAndSoDoesTheDeclaredRange) {
  put("a.csv", triangle(-0.2, -5.0));
  put("b.csv", triangle(0.0, -0.01));
  const auto campaign = read_campaign(put("campaign.json", R"({"bench": {"force_range_N": [-8, 0]}, "records": [{"file": "a.csv", "m_N": -2.6}, {"file": "b.csv"}]})"));
  ASSERT_TRUE(campaign) << campaign.error().to_text();
  EXPECT_DOUBLE_EQ(campaign->records[0].m_N.value(), 2.6);
  EXPECT_DOUBLE_EQ(first_N(*campaign), 5.0);
  EXPECT_DOUBLE_EQ(first_N(*campaign, 1), 0.01);
  EXPECT_DOUBLE_EQ(campaign->bench.force_min_N, 0.0);
  EXPECT_DOUBLE_EQ(campaign->bench.force_max_N, 8.0);
  put("b.csv", triangle(0.2, 5.0));
  const auto mixed = read_campaign(folder_ / "campaign.json");
  ASSERT_TRUE(mixed);
  EXPECT_DOUBLE_EQ(first_N(*mixed), -5.0) << "one of them pulls, or is of another cell";
}

TEST_F(Compression, ARecordingThatTheGateReadsIsTurnedOverToo) {
  const auto file = read_mapped_trace(put("a.csv", triangle(-0.2, -5.0)), "");
  ASSERT_TRUE(file) << file.error().to_text();
  EXPECT_DOUBLE_EQ(file->trace.find("F_ref")->value.front(), 5.0);
  EXPECT_THAT(file->notes, Contains(HasSubstr("turned over")));
}

TEST_F(Compression, IsAskedOfEveryPhaseOfACycleHoweverManyRowsThereAre) {
  constexpr int kRows = 250000;  // 25 of them for one that is looked at
  for (const int period : {25, 5, 50, 23}) {
    TraceFile file;
    file.trace.time_bases.emplace_back();
    Channel force{"F_ref", "N", "force", 0, {}, {}};
    for (int i = 0; i < kRows; ++i) {
      file.trace.time_bases[0].t_s.push_back(0.02 * i);
      force.value.push_back(1.0 - 2.0 * std::cos(2.0 * std::numbers::pi * i / period));
    }
    file.trace.channels.push_back(force);
    turn_compression_over(file);
    EXPECT_THAT(file.notes, ::testing::IsEmpty()) << period;
    EXPECT_DOUBLE_EQ(file.trace.find("F_ref")->value.front(), -1.0) << period;
  }
}

}  // namespace
}  // namespace forcegate
