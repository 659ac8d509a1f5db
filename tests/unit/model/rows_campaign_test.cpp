// What records are to each other: mountings and start times.

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "hil/model/rows.h"
#include "synthetic.h"

namespace forcegate {
namespace {

CampaignInput input() {
  auto made = make_campaign_input(test::campaign([](double, double F) { return 2.0 * F - 0.2; }));
  EXPECT_TRUE(made.has_value());
  return std::move(*made);
}

TEST(Mounting, IsThatOfTheNeighboursWhereARecordDoesNotSay) {
  CampaignInput campaign = input();
  ASSERT_GE(campaign.records.size(), 3u);
  campaign.records.resize(3);
  const auto numbered = [&](std::vector<std::string> names) {
    for (std::size_t k = 0; k < names.size(); ++k) campaign.records[k].mounting_name = names[k];
    for (RecordInput& r : campaign.records) r.mounting = -1;
    campaign.mountings = 0;
    finish_campaign_input(campaign);
    std::vector<int> out = {campaign.mountings};
    for (const RecordInput& r : campaign.records) out.push_back(r.mounting);
    return out;
  };
  EXPECT_EQ(numbered({"a", "b", "a"}), (std::vector<int>{2, 0, 1, 0}));
  EXPECT_EQ(numbered({"a", "", "a"}), (std::vector<int>{1, 0, 0, 0}));
  EXPECT_EQ(numbered({"", "a", "b"}), (std::vector<int>{2, 0, 0, 1}));
  EXPECT_EQ(numbered({"a", "", "b"}).front(), 0);
  EXPECT_EQ(numbered({"", "", ""}).front(), 0);
}

TEST(StartTimes, AreThoseOfAClockThatGoesOnFromRecordToRecord) {
  CampaignInput campaign = input();
  ASSERT_GE(campaign.records.size(), 3u);
  campaign.records.resize(3);
  const auto starts = [&](std::array<double, 3> clock_s) {
    for (std::size_t k = 0; k < 3; ++k) {
      campaign.records[k].start_s = campaign.records[k].rest_before_s = kMissing;
      campaign.records[k].clock_start_s = clock_s[k];
    }
    campaign.has_start_times = true;
    finish_campaign_input(campaign);
    std::vector<double> out = {campaign.has_start_times ? 1.0 : 0.0};
    for (const RecordInput& r : campaign.records) out.push_back(r.start_s);
    return out;
  };
  EXPECT_EQ(starts({1.7e9, 1.7e9 + 5000.0, 1.7e9 + 12000.0}), (std::vector<double>{1.0, 0.0, 5000.0, 12000.0}));
  EXPECT_EQ(starts({9000.0, 1000.0, 5000.0}), (std::vector<double>{1.0, 0.0, 4000.0, 8000.0})) << "named in another order";
  EXPECT_EQ(starts({0.0, 0.0, 0.0}).front(), 0.0) << "a clock of each record's own";
  EXPECT_EQ(starts({2.0, 1.5, 3.0}).front(), 0.0) << "no record begins before another has ended";
}

}  // namespace
}  // namespace forcegate
