#include "hil/gate/budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hil/gate/case_json.h"

namespace forcegate {
namespace {

CaseRecord record(double f_Hz, double u_time_s) {
  CaseRecord r;
  r.id = "sine/q50";
  r.facts.lowest_frequency_Hz = f_Hz;
  r.u_lag_s = 0.0005;
  r.rig.reference_u_time_s = u_time_s;
  return r;
}

Budget budget(const CaseRecord& r) { return mre_budget({}, r, 3.0, 0.001, 100, 0.005); }

double synchronisation_pct(const CaseRecord& r) {
  const Budget b = budget(r);
  const auto line = std::find_if(b.lines.begin(), b.lines.end(), [](const BudgetLine& l) { return l.name == "synchronisation"; });
  return line == b.lines.end() ? std::nan("") : line->u;
}

TEST(Budget, the_declared_time_of_a_reading_is_a_part_of_its_synchronisation) {
  EXPECT_NEAR(synchronisation_pct(record(0.5, 0.1)), 100.0 * (1.0 - std::cos(0.31417)), 1e-3);
  EXPECT_LT(synchronisation_pct(record(0.5, 0.0)), 2e-4);
  EXPECT_GT(budget(record(0.5, 0.1)).u(), budget(record(0.5, 0.0)).u() + 3.0);
}

// 0.002 s is the largest that rigs/*.toml declare, half a period of the slowest stream of an ATI is 0.0018 s; the fastest
// profile of the plans for a bench is 0.5 Hz.
TEST(Budget, what_the_delivered_benches_declare_is_far_below_what_tips_a_verdict) {
  EXPECT_LT(synchronisation_pct(record(0.5, 0.002)), 0.003);
  EXPECT_NEAR(budget(record(0.5, 0.002)).u(), budget(record(0.5, 0.0)).u(), 1e-4);
}

// An ATI that is off by what the slope lets pass is no property of the rig that the limit was derived on.
TEST(Budget, what_this_record_showed_of_the_ati_counts_against_a_derived_limit) {
  CaseRecord r = record(0.5, 0.0);
  r.rig.reference_u_rel = 0.005;
  const double sound = budget(r).u_against_derived();
  EXPECT_LT(sound, 0.2);
  r.observed.spring_samples = 1000;
  r.observed.spring_slope = 0.985;
  EXPECT_NEAR(budget(r).u_against_derived(), std::hypot(sound, 1.5 / std::sqrt(3.0)), 1e-6);
  EXPECT_NEAR(budget(r).u_of_this_record(), 1.5 / std::sqrt(3.0), 1e-6);
}

double part(const Budget& b, const std::string& name) {
  const auto line = std::find_if(b.lines.begin(), b.lines.end(), [&](const BudgetLine& l) { return l.name == name; });
  return line == b.lines.end() ? std::nan("") : line->u;
}

TEST(Budget, of_a_mean_absolute_error_has_its_repeatability) {
  const Budget b = mae_budget({}, record(0.5, 0.0), 0.3, 0.004, 100, 0.005);
  EXPECT_NEAR(part(b, "repeatability"), 0.004, 1e-12);
  EXPECT_GE(b.u_against_derived(), 0.004);
  EXPECT_TRUE(std::isnan(part(mae_budget({}, record(0.5, 0.0), 0.3, std::nan(""), 1, 0.005), "repeatability"))) << "one item has no spread";
}

TEST(Budget, of_a_mean_absolute_error_is_a_number_around_0_N) {
  CaseRecord r = record(0.5, 0.0);
  r.observed.zero_start_N = 0.006;
  r.observed.spring_samples = 1000;
  r.observed.spring_slope = 0.99;
  EXPECT_NEAR(part(mae_budget({}, r, 0.0, 0.001, 100, 0.005), "drift"), 0.006 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(part(mae_budget({}, r, 0.5, 0.001, 100, 0.005), "drift"), std::hypot(0.006, 0.005) / std::sqrt(3.0), 1e-12);
}

TEST(Budget, a_record_that_is_judged_again_has_the_time_too) {
  const auto again = record_from_json(to_json(record(0.5, 0.1)));
  ASSERT_TRUE(again) << again.error().to_text();
  EXPECT_EQ(synchronisation_pct(*again), synchronisation_pct(record(0.5, 0.1)));
}

}  // namespace
}  // namespace forcegate
