#include "hil/diagnose/raw/matched_lowpass.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace forcegate::diagnose {
namespace {

constexpr double kCorner_Hz = 2.0, kTau_s = 1.0 / (2.0 * std::numbers::pi * kCorner_Hz);

Record recorded(double step_s, std::size_t n, const std::function<double(double t_s)>& output) {
  Record r;
  TimeBase clock;
  Channel U;
  U.name = "U";
  for (std::size_t i = 0; i < n; ++i) clock.t_s.push_back(step_s * static_cast<double>(i)), U.value.push_back(output(clock.t_s.back()));
  r.trace.time_bases.push_back(std::move(clock));
  r.trace.channels.push_back(std::move(U));
  return r;
}

const std::vector<double>& output_of(const Record& r) { return r.trace.find("U")->value; }

TEST(MatchedLowpass, ARampIsLateByTheTimeConstant) {
  for (const double step_s : {0.0001, 0.001}) {
    Record r = recorded(step_s, 40 + static_cast<std::size_t>(1.0 / step_s), [](double t) { return 3.0 * t; });
    match_reference_lowpass(r, {}, kCorner_Hz);
    const double end_s = r.trace.time_bases[0].t_s.back();
    EXPECT_NEAR(output_of(r).back(), 3.0 * (end_s - kTau_s + 0.5 * step_s), 1e-5) << step_s;
  }
}

TEST(MatchedLowpass, SamplesFurtherApartThanItRemembersPassUnchanged) {
  Record r = recorded(1.0, 20, [](double t) { return 3.0 * t; });
  match_reference_lowpass(r, {}, kCorner_Hz);
  EXPECT_NEAR(output_of(r).back(), 57.0, 1e-4);
}

TEST(MatchedLowpass, ASineAtTheCornerLosesThreeDecibels) {
  Record r = recorded(0.001, 8000, [](double t) { return std::sin(2.0 * std::numbers::pi * kCorner_Hz * t); });
  match_reference_lowpass(r, {}, kCorner_Hz);
  double highest = 0.0;
  for (const double u : output_of(r))
    if (std::isfinite(u)) highest = std::fmax(highest, u);
  EXPECT_NEAR(highest, std::sqrt(0.5), 2e-3);
}

TEST(MatchedLowpass, WhatTheFilterHeldIsNotKnownAtTheStartNorAfterAStretchWithoutSamples) {
  Record r = recorded(0.001, 4000, [](double t) { return t; });
  for (std::size_t i = 2000; i < 2100; ++i) r.trace.find("U")->value[i] = kMissing;
  match_reference_lowpass(r, {}, kCorner_Hz);
  const std::vector<double>& U = output_of(r);
  const auto settling = static_cast<std::size_t>(5.0 * kTau_s / 0.001);
  EXPECT_FALSE(std::isfinite(U[settling - 1]));
  EXPECT_TRUE(std::isfinite(U[settling + 2]));
  EXPECT_TRUE(std::isfinite(U[1999]));
  EXPECT_FALSE(std::isfinite(U[2099 + settling - 1]));
  EXPECT_TRUE(std::isfinite(U[2100 + settling + 2]));
}

TEST(MatchedLowpass, RowsThatTheLoggerLostAreSuchAStretch) {
  Record r = recorded(0.001, 4000, [](double t) { return t; });
  for (std::size_t i = 2000; i < 4000; ++i) r.trace.time_bases[0].t_s[i] += 0.5;
  match_reference_lowpass(r, {}, kCorner_Hz);
  const auto settling = static_cast<std::size_t>(5.0 * kTau_s / 0.001);
  EXPECT_TRUE(std::isfinite(output_of(r)[1999]));
  EXPECT_FALSE(std::isfinite(output_of(r)[2000]));
  EXPECT_FALSE(std::isfinite(output_of(r)[2000 + settling - 1]));
  EXPECT_TRUE(std::isfinite(output_of(r)[2000 + settling + 2]));
}

TEST(MatchedLowpass, ASpikeThatIsMarkedLeavesNoTrace) {
  const auto ramp = [](double t) { return t; };
  Record with = recorded(0.001, 3000, ramp), without = recorded(0.001, 3000, ramp);
  std::vector<std::uint8_t> bad(3000, 0);
  bad[1500] = 1;
  with.trace.find("U")->value[1500] = 9.0;
  match_reference_lowpass(with, bad, kCorner_Hz);
  match_reference_lowpass(without, {}, kCorner_Hz);
  EXPECT_EQ(output_of(with)[1500], 9.0) << "still marked, and still what was recorded";
  for (std::size_t i = 1501; i < 3000; ++i) ASSERT_NEAR(output_of(with)[i], output_of(without)[i], 2e-5) << i;
}

}  // namespace
}  // namespace forcegate::diagnose
