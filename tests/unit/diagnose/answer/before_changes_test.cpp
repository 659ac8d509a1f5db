#include "hil/diagnose/answer/before_changes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace forcegate::diagnose {
namespace {

// 1000 rows of 10 ms, two of them; in the second one the frequency changes at 6 s.
struct Made {
  CampaignInput input;
  ResidualChannel channel;
  std::vector<std::vector<double>> residual;
};

Made made(const std::function<double(double t_s, double F_N)>& left) {
  Made out;
  out.input.records.resize(2);
  out.channel.record_of = {0, 1};
  out.channel.rows.resize(2);
  out.residual.resize(2);
  for (std::size_t k = 0; k < 2; ++k) {
    RecordInput& r = out.input.records[k];
    r.dynamic = true;
    for (std::size_t i = 0; i < 1000; ++i) {
      r.t_s.push_back(0.01 * static_cast<double>(i));
      r.F_N.push_back(2.0 + std::sin(7.0 * r.t_s.back()));
      out.channel.rows[k].row.push_back(i);
      out.residual[k].push_back(left(r.t_s.back(), r.F_N.back()));
    }
  }
  out.input.records[1].frequency_jumps_s = {6.0};
  return out;
}

double largest(const std::vector<double>& e) {
  double out = 0.0;
  for (const double v : e) out = std::max(out, std::abs(v));
  return out;
}

TEST(BeforeChanges, GainAndZeroThatDriftAreTheDecaysAndNothingBehindTheChangeCounts) {
  const Made m = made([](double t, double F) { return t < 6.0 ? 0.1 + 0.02 * t + (0.05 - 0.01 * t) * F : 5.0; });
  const auto out = before_changes_of_frequency(m.input, m.channel, m.residual);
  EXPECT_EQ(out[0], m.residual[0]) << "no change, no care";
  ASSERT_EQ(out[1].size(), 600U);
  EXPECT_LT(largest(out[1]), 1e-9);
}

TEST(BeforeChanges, WhatFollowsTheForceOtherwiseStays) {
  const Made m = made([](double, double F) { return 0.1 * F * F; });
  const auto out = before_changes_of_frequency(m.input, m.channel, m.residual);
  EXPECT_GT(largest(out[1]), 0.03);
}

TEST(BeforeChanges, AFewRowsBeforeItSayNothing) {
  Made m = made([](double, double F) { return F * F; });
  m.input.records[1].frequency_jumps_s = {0.5};
  EXPECT_TRUE(before_changes_of_frequency(m.input, m.channel, m.residual)[1].empty());
}

}  // namespace
}  // namespace forcegate::diagnose
