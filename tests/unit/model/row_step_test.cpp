#include "hil/model/row_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "hil/base/rng.h"

namespace forcegate {
namespace {

// One recording of `seconds` at `rate_Hz`.
Campaign recording(double rate_Hz, double seconds, const std::function<double(double)>& force, double noise_N = 0.0) {
  Record record;
  record.trace.time_bases.emplace_back();
  Channel F;
  F.name = "F_ref";
  Rng rng(61, "row step");
  for (int i = 0; i < static_cast<int>(rate_Hz * seconds); ++i) {
    record.trace.time_bases.front().t_s.push_back(i / rate_Hz);
    F.value.push_back(force(i / rate_Hz) + noise_N * rng.normal());
  }
  record.trace.channels.push_back(std::move(F));
  Campaign out;
  out.records.push_back(std::move(record));
  return out;
}

double row_step_of_one(const Campaign& campaign) { return row_step_of(campaign.records.front(), 1); }

double sine(double t, double f_Hz) { return 2.0 + std::sin(2.0 * std::numbers::pi * f_Hz * t); }

TEST(RowStep, OfALongSlowRecordingIsAFiftiethOfASecond) {
  EXPECT_EQ(row_step_of_one(recording(500.0, 120.0, [](double t) { return sine(t, 1.0); })), 0.02);
}

TEST(RowStep, OfAShortOneIsAFiveThousandthOfIt) {
  EXPECT_NEAR(row_step_of_one(recording(1000.0, 10.0, [](double t) { return sine(t, 1.0); })), 0.002, 1e-6);
}

TEST(RowStep, ResolvesAForceThatIsFasterThanTheRows) {
  const auto step = [](double f_Hz) { return row_step_of_one(recording(600.0, 60.0, [=](double t) { return sine(t, f_Hz); })); };
  EXPECT_LT(step(70.0), 0.25 / 70.0);
  EXPECT_LT(step(30.0), 0.25 / 30.0);
}

// A wide band up to a third of the rate hangs together from sample to sample hardly more than noise.
TEST(RowStep, ResolvesAWideBandThatTheOutputFollows) {
  constexpr double kRate_Hz = 600.0;
  Rng rng(62, "row step");
  std::vector<double> white;
  for (int i = 0; i < 22000; ++i) white.push_back(rng.normal());
  const auto smoothed = [&](double t) {
    const auto i = static_cast<std::size_t>(std::lround(t * kRate_Hz)) + 2;
    return 0.6 * white[i] + 0.3 * (white[i - 1] + white[i + 1]);
  };
  Campaign wide = recording(kRate_Hz, 33.0, smoothed);
  EXPECT_GT(row_step_of_one(wide), 2.5 / kRate_Hz);
  Channel output = wide.records.front().trace.channels.front();
  output.name = "U";
  std::vector<double>& U = output.value;
  for (std::size_t i = U.size() - 1; i > 2; --i) U[i] = 0.5 * U[i] + U[i - 1] - 0.4 * U[i - 3];
  for (double& u : U) u += 0.2 * rng.normal();
  Campaign followed = wide, unheeded = wide;
  followed.records.front().trace.channels.push_back(output);
  for (double& u : U) u = rng.normal();
  unheeded.records.front().trace.channels.push_back(output);
  EXPECT_LT(row_step_of_one(followed), 1.5 / kRate_Hz);
  EXPECT_EQ(row_step_of_one(unheeded), row_step_of_one(wide));
}

TEST(RowStep, IsNotShortenedForNoise) {
  EXPECT_GT(row_step_of_one(recording(600.0, 100.0, [](double t) { return sine(t, 0.5); }, 1.0)), 0.019);
}

TEST(RowStep, LeavesALongFastRecordingItsRows) {
  EXPECT_EQ(row_step_of_one(recording(300.0, 1200.0, [](double t) { return sine(t, 70.0); })), 0.02) << "60 000 rows as it is";
}

TEST(RowStep, OfSeveralRecordsEachHasItsOwn) {
  const Record slow = recording(600.0, 20.0, [](double t) { return sine(t, 1.0); }).records.front(), fast = recording(600.0, 20.0, [](double t) { return sine(t, 70.0); }).records.front();
  EXPECT_EQ(row_step_of(slow, 3), 0.02);
  EXPECT_LT(row_step_of(fast, 3), 0.006);
  EXPECT_GT(row_step_of(fast, 20), 0.009) << "2000 rows are left for each";
}

TEST(RowStep, AnImpactOfHalfASecondIsResolved) {
  const Record hit = recording(5000.0, 0.6, [](double t) { return 3.0 + 80.0 * std::exp(-std::pow((t - 0.2) / 0.004, 2)); }).records.front();
  EXPECT_LT(row_step_of(hit, 10), 0.003);
}

}  // namespace
}  // namespace forcegate
