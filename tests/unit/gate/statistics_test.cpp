#include "hil/gate/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace forcegate {
namespace {

TEST(Statistics, student_distribution_agrees_with_tables) {
  EXPECT_NEAR(student_cdf(2.306004, 8), 0.975, 1e-6);
  EXPECT_NEAR(student_cdf(-2.896459, 8), 0.01, 1e-6);
  EXPECT_NEAR(student_cdf(1.0, 1), 0.75, 1e-12);
  EXPECT_NEAR(student_cdf(1.959964, 1e9), 0.975, 1e-6);
}

TEST(Statistics, coverage_factors_are_those_of_the_GUM) {
  // GUM (JCGM 100:2008), table G.2, p = 95.45 %
  EXPECT_NEAR(coverage_factor(0.9545, 1), 13.97, 0.01);
  EXPECT_NEAR(coverage_factor(0.9545, 8), 2.37, 0.01);
  EXPECT_NEAR(coverage_factor(0.9545, 20), 2.13, 0.01);
  EXPECT_NEAR(coverage_factor(0.9545, 0), 2.00, 0.001);
}

TEST(Statistics, chi_square_agrees_with_tables) {
  EXPECT_NEAR(chi_square_99(1), 6.635, 0.15);
  EXPECT_NEAR(chi_square_99(3), 11.345, 0.1);
  EXPECT_NEAR(chi_square_99(10), 23.209, 0.1);
  EXPECT_NEAR(chi_square_99(100), 135.807, 0.2);
}

TEST(Statistics, holm_rejects_step_by_step) {
  // Holm (1979): p = 0.01, 0.04, 0.03, 0.005 at 0.05 rejects 0.005 and 0.01 only.
  const double p[] = {0.01, 0.04, 0.03, 0.005};
  EXPECT_EQ(holm(p, 0.05), (std::vector<bool>{true, false, false, true}));
}

TEST(Statistics, holm_never_rejects_what_is_not_a_number) {
  const double p[] = {std::nan(""), 0.0};
  EXPECT_EQ(holm(p, 0.05), (std::vector<bool>{false, true}));
}

TEST(Statistics, the_bound_of_a_quantile_is_the_order_statistic_of_wilks) {
  std::vector<double> values(473);
  std::iota(values.begin(), values.end(), 1.0);
  // First and second failure of a 95/99 tolerance limit need 299 and 473 values.
  EXPECT_EQ(quantile_bound_95(values, 0.99).value, 472.0);
  values.pop_back();
  EXPECT_EQ(quantile_bound_95(values, 0.99).value, 472.0);
  values.resize(299);
  std::reverse(values.begin(), values.end());
  EXPECT_EQ(quantile_bound_95(values, 0.99).value, 299.0);
  EXPECT_TRUE(quantile_bound_95(values, 0.99).reached);
  values.erase(values.begin());
  EXPECT_EQ(quantile_bound_95(values, 0.99).value, 298.0);
  EXPECT_FALSE(quantile_bound_95(values, 0.99).reached);
  EXPECT_TRUE(std::isnan(quantile_bound_95({std::nan("")}, 0.99).value));
}

TEST(Statistics, the_bound_of_a_quantile_covers_it_as_often_as_it_says) {
  std::mt19937_64 random(7);
  std::exponential_distribution<double> heavy(1.0);
  const double p90 = -std::log(0.1);
  int covered = 0;
  for (int k = 0; k < 2000; ++k) {
    std::vector<double> values(100);
    for (double& v : values) v = std::pow(heavy(random), 2.0);
    covered += quantile_bound_95(values, 0.9).value >= p90 * p90;
  }
  EXPECT_GE(covered, 1900 - 3 * 10);  // sd of the count: 10
}

TEST(Statistics, clopper_pearson_gives_the_published_intervals) {
  EXPECT_NEAR(clopper_pearson_95(0, 59).high, 0.0495, 1e-4);  // "59 clean runs claim less than 5 %"
  EXPECT_NEAR(clopper_pearson_95(0, 299).high, 0.00997, 1e-5);
  EXPECT_EQ(clopper_pearson_95(0, 59).low, 0.0);
  EXPECT_NEAR(clopper_pearson_95(59, 59).low, 0.9505, 1e-4);
  EXPECT_NEAR(clopper_pearson_95(5, 20).low, 0.0866, 1e-4);
  EXPECT_NEAR(clopper_pearson_95(5, 20).high, 0.4910, 1e-4);
  EXPECT_EQ(clopper_pearson_95(0, 0).high, 1.0);
}

TEST(Statistics, quantile_and_moments_leave_out_what_is_not_finite) {
  EXPECT_DOUBLE_EQ(sample_quantile({3.0, std::nan(""), 1.0, 2.0}, 0.5), 2.0);
  const double v[] = {1.0, std::nan(""), 3.0};
  EXPECT_DOUBLE_EQ(moments(v).mean, 2.0);
  EXPECT_DOUBLE_EQ(moments(v).sd, std::sqrt(2.0));
}

}  // namespace
}  // namespace forcegate
