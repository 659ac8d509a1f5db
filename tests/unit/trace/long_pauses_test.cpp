#include "hil/trace/long_pauses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class LongPauses : public FolderTest {
 protected:
  /// Runs of 200 samples at 20 Hz, each with a load of its own, `pause_s` apart.
  static std::string rows(const std::vector<double>& loads_N, double pause_s, const std::vector<std::size_t>& samples = {}) {
    std::string out = "t_s,F_ref_N,U_V\n";
    double t = 100.0;
    for (std::size_t k = 0; k < loads_N.size(); ++k) {
      const std::size_t n = k < samples.size() ? samples[k] : 200;
      for (std::size_t i = 0; i < n; ++i, t += 0.05) {
        const double F = loads_N[k] * (1.0 - 0.9 * std::cos(0.1 * static_cast<double>(i)));
        out += std::to_string(t) + "," + std::to_string(F) + "," + std::to_string(0.3 * F + 0.1) + "\n";
      }
      t += pause_s;
    }
    return out;
  }
  std::vector<Record> read(const std::string& text) {
    put("log.csv", text);
    auto campaign = read_campaign(folder_ / "log.csv");
    EXPECT_TRUE(campaign) << campaign.error().to_text();
    notes_ = campaign ? campaign->notes : std::vector<std::string>{};
    return campaign ? campaign->records : std::vector<Record>{};
  }
  std::vector<std::string> notes_;
};

TEST_F(LongPauses, PartRecordsWithTheirTimesAndRests) {
  const std::vector<Record> records = read(rows({1.0, 1.5, 2.0, 0.7}, 600.0));
  ASSERT_EQ(records.size(), 4u);
  EXPECT_EQ(records.front().name, "log_1");
  EXPECT_EQ(records.back().name, "log_4");
  EXPECT_FALSE(records.front().rest_before_s.has_value());
  ASSERT_TRUE(records[1].rest_before_s.has_value());
  EXPECT_NEAR(*records[1].rest_before_s, 600.05, 1e-3);
  EXPECT_NEAR(records[1].trace.time_bases.front().t_s.front(), 100.0 + 10.0 + 600.0, 1e-3) << "the clock of the file";
  for (const Record& r : records) {
    EXPECT_EQ(r.trace.size(), 200u);
    EXPECT_TRUE(r.trace.time_bases.front().gaps.empty());
    EXPECT_NEAR(r.trace.time_bases.front().nominal_rate_Hz, 20.0, 0.01);
    EXPECT_EQ(r.file, folder_ / "log.csv");
  }
  EXPECT_THAT(notes_, Contains(HasSubstr("4 records, log_1 to log_4")));
}

TEST_F(LongPauses, NoSampleIsLost) {
  const std::vector<Record> records = read(rows({1.0, 1.5, 2.0, 0.7}, 600.0));
  std::size_t samples = 0;
  for (const Record& r : records) samples += r.trace.find("F_ref")->value.size();
  EXPECT_EQ(samples, 800u);
}

TEST_F(LongPauses, GapsOfSecondsAndTwoPartsAreOneRecord) {
  EXPECT_EQ(read(rows({1.0, 1.5, 2.0, 0.7}, 20.0)).size(), 1u);
  EXPECT_EQ(read(rows({1.0, 1.5}, 600.0)).size(), 1u);
  EXPECT_THAT(notes_, Not(Contains(HasSubstr("the logger paused"))));
}

TEST_F(LongPauses, AFewSamplesBetweenTwoAreLeftOutAndTold) {
  const std::vector<Record> records = read(rows({1.0, 1.5, 2.0, 0.7}, 600.0, {200, 30, 200, 200}));
  ASSERT_EQ(records.size(), 3u);
  EXPECT_THAT(notes_, Contains(HasSubstr("fewer than 64 samples")));
}

// A logger that wakes for ten seconds in every ten minutes under one weight.
TEST_F(LongPauses, ALoadThatStandsThroughIsOneHold) {
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int k = 0; k < 5; ++k)
    for (int i = 0; i < 200; ++i) {
      const double t = 600.0 * k + 0.05 * i, F = k == 0 && i < 20 ? 0.0 : 2.0;
      text += std::to_string(t) + "," + std::to_string(F) + "," + std::to_string(0.3 * F + 0.001 * std::log1p(t)) + "\n";
    }
  EXPECT_EQ(read(text).size(), 1u);
}

TEST_F(LongPauses, AFileThatIsListedStaysWhatItIs) {
  put("log.csv", rows({1.0, 1.5, 2.0, 0.7}, 600.0));
  put("campaign.json", R"({"records": [{"file": "log.csv"}]})");
  const auto campaign = read_campaign(folder_);
  ASSERT_TRUE(campaign) << campaign.error().to_text();
  EXPECT_EQ(campaign->records.size(), 1u);
}

TEST_F(LongPauses, WhatTheCampaignSaysOfItsRunsIsOfThePartsInTheirOrder) {
  put("log.csv", rows({1.0, 1.5, 2.0, 0.7}, 600.0));
  put("campaign.json", R"({"room_temp_degC": [41.3, 33.0, 22.2, 36.2], "note": "RH % per run: 47 56 54 51"})");
  const auto campaign = read_campaign(folder_);
  ASSERT_TRUE(campaign) << campaign.error().to_text();
  ASSERT_EQ(campaign->records.size(), 4u);
  EXPECT_EQ(campaign->records[0].temp_C, 41.3);
  EXPECT_EQ(campaign->records[3].temp_C, 36.2);
  EXPECT_EQ(campaign->records[1].humidity_pct, 56.0);
  EXPECT_THAT(campaign->notes, Contains(HasSubstr("the temperature of 4 records is taken from what campaign.json says")));
}

}  // namespace
}  // namespace forcegate
