#include "hil/model/travel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hil/base/rng.h"
#include "synthetic.h"

namespace forcegate {
namespace {

RecordInput record(std::vector<double> F_N) {
  RecordInput r;
  r.ok.assign(F_N.size(), 1);
  for (std::size_t i = 0; i < F_N.size(); ++i) r.t_s.push_back(0.02 * static_cast<double>(i));
  r.F_N = std::move(F_N);
  return r;
}

std::vector<double> cycles(double amplitude_N, int n, double noise_N) {
  Rng rng(5, "travel");
  std::vector<double> out;
  for (int i = 0; i <= 50 * n; ++i) out.push_back(2.0 - amplitude_N * std::cos(2.0 * std::numbers::pi * i / 50.0) + noise_N * rng.normal());
  return out;
}

CampaignInput campaign(std::vector<RecordInput> records) {
  CampaignInput out;
  out.range_N = 4.0;
  out.records = std::move(records);
  add_up_travel(out);
  return out;
}

TEST(Travel, IsTheWayFromTurnToTurnForLargeAndSmallCycles) {
  for (const double amplitude_N : {1.5, 0.4, 0.07}) {
    const CampaignInput c = campaign({record(cycles(amplitude_N, 40, 0.0005))});
    EXPECT_NEAR(c.travel_total_N, 40 * 4.0 * amplitude_N, 0.03 * 40 * 4.0 * amplitude_N) << amplitude_N;
  }
}

TEST(Travel, NeverFallsAndGoesOnFromRecordToRecord) {
  const CampaignInput c = campaign({record(cycles(1.0, 3, 0.01)), record(cycles(0.5, 4, 0.01))});
  for (const RecordInput& r : c.records)
    for (std::size_t i = 1; i < r.rows(); ++i) ASSERT_GE(r.travel_N[i], r.travel_N[i - 1] - 1e-12);
  EXPECT_DOUBLE_EQ(c.records[1].travel_before_N, c.records[0].travel_N.back());
  EXPECT_DOUBLE_EQ(c.travel_total_N, c.records[1].travel_before_N + c.records[1].travel_N.back());
}

TEST(Travel, NoiseAndASlowZeroWearNothing) {
  Rng rng(7, "still");
  std::vector<double> still;
  for (int i = 0; i < 100000; ++i) still.push_back(2.0 + 0.01 * rng.normal() + 0.015 * std::sin(i / 9000.0));
  EXPECT_LT(campaign({record(still)}).travel_total_N, 0.5) << "a turn or two in half an hour, by chance";
}

TEST(Travel, CountsCyclesThatNobodyRecordedAsTheCycledRecordsSwing) {
  std::vector<RecordInput> records{record(cycles(0.5, 10, 0.0)), record(cycles(0.5, 10, 0.0))};
  const double recorded_N = campaign(records).travel_total_N;
  for (RecordInput& r : records) r.dynamic = true, r.A_N = 0.5;
  records[1].cycles_before = 100.0;
  const CampaignInput c = campaign(records);
  EXPECT_DOUBLE_EQ(c.records[0].travel_before_N, 0.0);
  EXPECT_DOUBLE_EQ(c.records[1].travel_before_N, c.records[0].travel_N.back() + 100.0 * 4.0 * 0.5);
  EXPECT_DOUBLE_EQ(c.travel_total_N, recorded_N + 200.0);
}

}  // namespace
}  // namespace forcegate
