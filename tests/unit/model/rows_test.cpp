// What the rows of a record are made of: blocks of samples, whatever columns the lab has.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/model/rows.h"
#include "synthetic.h"

namespace forcegate {
namespace {

TEST(Rows, AnAngleThatBeginsAnewAfterEveryTurnGoesOn) {
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  Record record = test::campaign([](double, double F) { return F; }).records[0];
  Channel theta = record.trace.channels[0];
  theta.name = "theta", theta.quantity = "angle", theta.unit = "rad";
  const auto& t_s = record.trace.time_bases[theta.time_base].t_s;
  for (std::size_t i = 0; i < t_s.size(); ++i) theta.value[i] = 3.0 * t_s[i];
  record.trace.channels.push_back(theta);
  const auto whole = make_record_input(record, {}, 0.05, {.full_rate = false, .angle = true});
  for (double& v : record.trace.channels.back().value) v = std::fmod(v, kTurn_rad);
  const auto wrapped = make_record_input(record, {}, 0.05, {.full_rate = false, .angle = true});
  ASSERT_TRUE(whole && wrapped);
  ASSERT_GT(whole->theta_rad.back(), 2.0 * kTurn_rad);
  for (std::size_t i = 0; i < whole->rows(); ++i) {
    ASSERT_NEAR(wrapped->theta_rad[i], whole->theta_rad[i], 1e-9) << i;
    ASSERT_NEAR(wrapped->cos_theta[i], whole->cos_theta[i], 1e-9) << i;
  }
}

TEST(Rows, NeedForceAndOutput) {
  Record record = test::campaign([](double, double F) { return F; }).records[0];
  record.trace.channels.erase(record.trace.channels.begin() + 1);
  const auto made = make_record_input(record);
  ASSERT_FALSE(made.has_value());
  EXPECT_NE(made.error().text.find("U"), std::string::npos);
}

TEST(Rows, AreTheSameWhetherTheRecordIsCopiedOrTakenAndWhateverIsLeftOut) {
  Record record = test::campaign([](double, double F) { return 2.0 * F; }).records[0];
  Channel theta = record.trace.channels[0];
  theta.name = "theta";
  record.trace.channels.push_back(theta);
  record.trace.channels[0].value[700] = kMissing;
  const auto copied = make_record_input(record);
  const auto bare = make_record_input(record, {}, kRowStep_s, {.full_rate = false, .angle = false});
  const auto taken = take_record_input(record, {}, kRowStep_s, {});
  ASSERT_TRUE(copied && bare && taken);
  EXPECT_EQ(copied->ok, bare->ok);
  EXPECT_EQ(std::count(copied->ok.begin(), copied->ok.end(), 0), 1);
  EXPECT_EQ(copied->F_N, bare->F_N);
  EXPECT_EQ(copied->theta_rad, bare->theta_rad);
  EXPECT_TRUE(bare->fast_F_N.empty() && bare->fast_t_s.empty() && bare->sin_theta.empty());
  EXPECT_EQ(copied->fast_F_N[700], copied->fast_F_N[699]);
  EXPECT_EQ(copied->fast_F_N, taken->fast_F_N);
  EXPECT_EQ(copied->fast_t_s, taken->fast_t_s);
  EXPECT_EQ(copied->late_cos_theta, taken->late_cos_theta);
  EXPECT_EQ(copied->cos_theta.size(), copied->rows());
}

TEST(Rows, AreBlockMeansOfAtMostFiftyASecond) {
  const auto made = make_record_input(test::campaign([](double, double F) { return 2.0 * F; }).records[0]);
  ASSERT_TRUE(made.has_value());
  EXPECT_NEAR(made->row_step_s, 0.02, 1e-9);
  for (std::size_t i = 0; i < made->rows(); ++i) EXPECT_NEAR(made->U_V[i], 2.0 * made->F_N[i], 1e-12);
}

TEST(Rows, ARecordShorterThanItsRowsIsAnError) {
  Record r = test::record("short", "ramp", 0.09, 0, [](double t) { return t; }, [](double, double F) { return F; });
  for (std::size_t i = 0; i < r.trace.time_bases[0].t_s.size(); ++i) r.trace.time_bases[0].t_s[i] = 1e-3 * static_cast<double>(i);
  Campaign c;
  c.records.push_back(std::move(r));
  const auto input = make_campaign_input(c);
  ASSERT_FALSE(input);
  EXPECT_NE(input.error().to_text().find("320 are needed"), std::string::npos) << input.error().to_text();
}

}  // namespace
}  // namespace forcegate
