// The recorded voltages as a converter would have read them.

#include "hil/app/export/recorded_output.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/app/export/compensator_check.h"
#include "hil/base/rng.h"
#include "hil/model/rows.h"

namespace forcegate {
namespace {

Campaign swings(double noise_V) {
  Campaign c;
  c.name = "c";
  Record r;
  r.name = "r";
  r.dynamic = false;
  r.trace.time_bases.emplace_back();
  r.trace.time_bases[0].nominal_rate_Hz = 1000.0;
  Channel F{"F_ref", "N", "force", 0, {}, {}}, U{"U", "V", "voltage", 0, {}, {}};
  Rng rng(3, "noise of a converter");
  for (int i = 0; i < 20000; ++i) {
    r.trace.time_bases[0].t_s.push_back(5.0 + 0.001 * i);
    F.value.push_back(2.0 + std::sin(0.001 * i));
    U.value.push_back(2.0 * F.value.back() + noise_V * rng.normal());
  }
  r.trace.channels = {F, U};
  c.records = {r};
  return c;
}

TEST(RecordedOutput, IsThatOfTheSamplesAndNotOfTheirMeans) {
  const Campaign c = swings(0.02);
  const auto input = make_campaign_input(c);
  ASSERT_TRUE(input) << input.error().to_text();
  const std::vector<double>& U = c.records[0].trace.find("U")->value;
  // the instants of a firmware lie anywhere between two samples
  const std::vector<double> at = recorded_output(c, input->records[0], {0.1004, 0.1014, 0.1024});
  ASSERT_EQ(at.size(), 3u);
  for (std::size_t i = 0; i < at.size(); ++i) EXPECT_EQ(at[i], U[100 + i]) << i;
}

TEST(RecordedOutput, OfARecordWithFewerSamplesRunsBetweenThem) {
  const Campaign c = swings(0.02);
  const auto input = make_campaign_input(c);
  ASSERT_TRUE(input);
  const std::vector<double>& U = c.records[0].trace.find("U")->value;
  const std::vector<double> at = recorded_output(c, input->records[0], {0.1, 0.10025, 0.1005});
  ASSERT_EQ(at.size(), 3u);
  EXPECT_NEAR(at[0], U[100], 1e-9);
  EXPECT_NEAR(at[2], 0.5 * (U[100] + U[101]), 1e-9);
}

TEST(RecordedOutput, MissingSamplesAreBridged) {
  Campaign c = swings(0.0);
  const auto input = make_campaign_input(c);
  ASSERT_TRUE(input);
  std::vector<double>& U = c.records[0].trace.find("U")->value;
  const double before = U[99], behind = U[101];
  U[100] = kMissing;
  EXPECT_NEAR(recorded_output(c, input->records[0], {0.1, 0.1005})[0], 0.5 * (before + behind), 1e-9);
  c.records[0].name = "another";
  EXPECT_TRUE(recorded_output(c, input->records[0], {0.1}).empty());
}

TEST(RecordedOutput, TheErrorOfAHeaderHoldsTheNoiseOfTheSamples) {
  constexpr double kNoise_V = 0.02;
  Model m;
  m.frame.span_N = 4.0;
  m.law.gain_N_per_V = 0.5;
  const auto made = make_compensator(m, {});
  ASSERT_TRUE(made);
  const auto check = check_compensator(m, *made, 1000.0, swings(kNoise_V));
  ASSERT_TRUE(check) << check.error().to_text();
  EXPECT_NEAR(check->raw_compensated_rms_N, 0.5 * kNoise_V, 0.1 * 0.5 * kNoise_V);
}

}  // namespace
}  // namespace forcegate
