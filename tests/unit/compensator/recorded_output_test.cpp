// The recorded voltages as a converter would have read them.

#include "hil/app/export/recorded_output.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/app/export/compensator_check.h"
#include "hil/base/rng.h"
#include "hil/model/model_toml.h"
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

Campaign fast_sine(double rate_Hz, double lag_s) {
  constexpr double kTwoPi = 6.283185307179586;
  Campaign c = swings(0.0);
  c.records[0].trace.time_bases[0] = {};
  c.records[0].trace.time_bases[0].nominal_rate_Hz = rate_Hz;
  Channel F{"F_ref", "N", "force", 0, {}, {}}, U{"U", "V", "voltage", 0, {}, {}};
  const double late = kTwoPi * 2.0 * lag_s, gain = 1.0 / std::sqrt(1.0 + late * late), phase = std::atan(late);
  for (int i = 0; i < static_cast<int>(60.0 * rate_Hz); ++i) {
    const double t = i / rate_Hz;
    c.records[0].trace.time_bases[0].t_s.push_back(t);
    F.value.push_back(2.0 + 1.2 * std::sin(kTwoPi * 2.0 * t));
    U.value.push_back(2.0 * (2.0 + 1.2 * gain * std::sin(kTwoPi * 2.0 * t - phase)));
  }
  c.records[0].trace.channels = {F, U};
  return c;
}

TEST(RecordedOutput, TheForceIsThatOfTheSameInstantAtEveryRate) {
  Model m;
  m.frame.span_N = 4.0;
  m.law.gain_N_per_V = 0.5;
  for (const double recorded_Hz : {40.0, 100.0, 250.0, 1000.0})
    for (const double rate_Hz : {100.0, recorded_Hz}) {
      CompensatorOptions options;
      options.rate_Hz = rate_Hz;
      const auto made = make_compensator(m, options);
      ASSERT_TRUE(made);
      const auto check = check_compensator(m, *made, rate_Hz, fast_sine(recorded_Hz, 0.0));
      ASSERT_TRUE(check) << check.error().to_text();
      EXPECT_LT(check->raw_compensated_rms_N, 1e-4) << recorded_Hz << " Hz, header at " << rate_Hz;
    }
}

TEST(RecordedOutput, AHeaderThatUndoesALagIsSeenToDoSoAtTheRateOfTheRecords) {
  const auto parsed = parse_model("[law]\nkind = \"static\"\nspan_N = 4.0\ngain_N_per_V = 0.5\noffset_N = 0.0\n[[effect]]\nname = \"lag\"\nshape.tau_s = 0.005\nstrength.c = 1.0\n", "lag.toml");
  ASSERT_TRUE(parsed) << parsed.error().to_text();
  const Model& m = *parsed;
  CompensatorOptions options;
  options.rate_Hz = 100.0;
  const auto made = make_compensator(m, options);
  ASSERT_TRUE(made) << made.error().to_text();
  const auto check = check_compensator(m, *made, 100.0, fast_sine(100.0, 0.005));
  ASSERT_TRUE(check) << check.error().to_text();
  EXPECT_GT(check->raw_plain_rms_N, 0.04);
  EXPECT_LT(check->raw_compensated_rms_N, 0.3 * check->raw_plain_rms_N);
  EXPECT_TRUE(objections(*check).empty());
}

}  // namespace
}  // namespace forcegate
