// The laws (5): fits, standard errors, errors on records, and what the printed tables give.

#include "hil/characterize/laws.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hil/base/rng.h"
#include "hil/characterize/printed_table.h"

namespace forcegate::characterize {
namespace {

DecayRecord exact_record(const Laws& laws, double f_Hz, double A_N, double m_N, const Calibration& c) {
  DecayRecord r;
  r.set = "series";
  r.f_Hz = f_Hz, r.A_N = A_N, r.m_N = m_N;
  r.duration_s = 1200.0;
  r.fitted = true;
  r.fit.a_V = laws.a_V(A_N);
  r.fit.b_per_s = laws.b_per_s(f_Hz);
  r.fit.c_V = r.fit.a_V * laws.ratio(A_N);
  r.u_min_V = (m_N - A_N - c.offset_N) / c.gain_N_per_V;
  return r;
}

std::vector<DecayRecord> series_of(const Laws& laws, const Calibration& c) {
  std::vector<DecayRecord> out;
  for (const PrintedRow& p : printed_table_II()) out.push_back(exact_record(laws, p.f_Hz, p.A_N, p.m_N, c));
  return out;
}

TEST(Laws, are_recovered_exactly_from_records_that_follow_them) {
  Laws truth;
  truth.a2_V_per_N2 = 0.7, truth.a1_V_per_N = 1.1, truth.b1_s_per_s = 0.003, truth.b0_per_s = 0.004,
  truth.k_per_N2 = 2.0;
  const auto records = series_of(truth, {});
  const std::vector<std::string> owner(records.size(), "one");
  const auto fitted = fit_laws(records, owner);
  ASSERT_TRUE(fitted.has_value());
  EXPECT_NEAR(fitted->a2_V_per_N2, 0.7, 1e-9);
  EXPECT_NEAR(fitted->a1_V_per_N, 1.1, 1e-9);
  EXPECT_NEAR(fitted->b1_s_per_s, 0.003, 1e-12);
  EXPECT_NEAR(fitted->b0_per_s, 0.004, 1e-12);
  EXPECT_NEAR(fitted->k_per_N2, 2.0, 1e-8);
  EXPECT_EQ(fitted->records, 20U);
}

TEST(Laws, standard_errors_are_those_of_the_scatter_between_specimens) {
  // Rates of 12 specimens scatter by 20 %: the mean rate is known to 20 % / sqrt(12), however many records each has.
  Rng rng(7, "laws");
  std::vector<double> errors, claimed;
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<DecayRecord> records;
    std::vector<std::string> owner;
    for (int k = 0; k < 12; ++k) {
      const double scale = 1.0 + 0.2 * rng.normal();
      for (DecayRecord r : series_of({}, {})) {
        r.fit.b_per_s *= scale;
        records.push_back(r);
        owner.push_back(std::to_string(k));
      }
    }
    const auto fitted = fit_laws(records, owner);
    ASSERT_TRUE(fitted.has_value());
    errors.push_back(fitted->b0_per_s - 0.0056);
    claimed.push_back(fitted->se_b0);
  }
  double rms = 0.0, mean = 0.0;
  for (std::size_t i = 0; i < errors.size(); ++i)
    rms += errors[i] * errors[i] / 60.0, mean += claimed[i] / 60.0;
  EXPECT_NEAR(mean / std::sqrt(rms), 1.0, 0.25);
}

TEST(Laws, have_no_error_on_records_that_follow_them_and_the_right_one_on_others) {
  Calibration c;
  c.offset_N = 0.15;
  const Laws laws;
  DecayRecord r = exact_record(laws, 0.5, 1.5, 2.7, c);
  const LawErrors none = errors_of_laws(laws, r, c);
  EXPECT_NEAR(none.a_pct + none.b_pct + none.c_pct + none.mre_pct, 0.0, 1e-9);
  r.fit.b_per_s *= 1.25;
  const LawErrors off = errors_of_laws(laws, r, c);
  EXPECT_NEAR(off.b_pct, 20.0, 1e-9);  // relative to what was measured
  EXPECT_NEAR(off.a_pct, 0.0, 1e-9);
  EXPECT_GT(off.mre_pct, 1.0);
  Calibration wrong = c;
  wrong.offset_N = 0.65;  // U_min by eq. (4) is 1 V too low
  EXPECT_NEAR(errors_of_laws(laws, exact_record(laws, 0.5, 1.5, 2.7, c), wrong).mre_pct, 100.0 / 4.0, 12.0);
}

TEST(Laws, are_refused_when_the_records_do_not_determine_them) {
  std::vector<DecayRecord> same(5, exact_record({}, 0.5, 1.5, 2.7, {}));
  EXPECT_FALSE(fit_laws(same, std::vector<std::string>(5, "x")).has_value());
  for (DecayRecord& r : same) r.fitted = false;
  EXPECT_FALSE(fit_laws(same, std::vector<std::string>(5, "x")).has_value());
}

TEST(PrintedTable, is_missed_by_eq_5_by_18_21_and_31_percent_and_loses_78_or_75_percent) {
  const PrintedErrors e = errors_on_printed_table();
  EXPECT_NEAR(e.a_pct, 18.0, 0.5);
  EXPECT_NEAR(e.b_pct, 21.0, 0.5);
  EXPECT_NEAR(e.c_pct, 31.0, 0.5);
  EXPECT_NEAR(e.loss_printed_pct, 78.0, 0.5);
  EXPECT_NEAR(e.loss_laws_pct, 75.0, 0.5);
}

TEST(PrintedTable, holds_no_significant_dependence_that_the_laws_leave_out) {
  const auto found = search_printed_table();
  ASSERT_GE(found.size(), 12U);
  for (const LeftOut& x : found) {
    EXPECT_FALSE(x.significant) << x.parameter << " on " << x.term;
    EXPECT_GT(x.loo_before_pct, 0.0);
  }
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end(),
                             [](const LeftOut& a, const LeftOut& b) { return a.p < b.p; }));
  EXPECT_LT(found.front().p,
            0.05);  // one alone would look significant: that is why all are corrected together
}

}  // namespace
}  // namespace forcegate::characterize
