#pragma once
// The few distributions and the multiple-testing rule that the decision needs.

#include <span>
#include <vector>

namespace forcegate {

/// P(Z <= z) of the standard normal.
double normal_cdf(double z);

/// P(T <= t) of Student's t; dof <= 0 or > 1e6: normal. Absolute error < 1e-10.
double student_cdf(double t, double dof);

/// k so that P(-k <= T <= k) = coverage; coverage in (0, 1). k(0.9545, inf) = 2.000.
double coverage_factor(double coverage, double dof);

/// Value that chi-square with `dof` degrees of freedom exceeds with probability 0.01 (Wilson and Hilferty 1931,
/// error below 1 % from dof = 2).
double chi_square_99(double dof);

struct Moments {
  double mean = 0.0, sd = 0.0;  ///< sample standard deviation, n - 1; NaN below two items
  std::size_t n = 0;            ///< finite items
};
Moments moments(std::span<const double> values);

/// Value below which the share p of the items lies (linear between order statistics, type 7); NaN when empty.
double sample_quantile(std::vector<double> values, double p);

/// Item that is, with 95 % confidence, not below the quantile p of what the items were drawn from, whatever the
/// distribution (order statistic r, the smallest with P(Bin(n, p) < r) >= 0.95; Wilks 1941). `reached` is false
/// when n is too small for any item to say so (p = 0.99: below 299); it is the largest one then. NaN when empty.
struct QuantileBound {
  double value = 0.0;
  bool reached = false;
};
QuantileBound quantile_bound_95(std::vector<double> values, double p);

/// Interval of Clopper and Pearson (1934) for a probability after k successes in n trials; n = 0: [0, 1].
/// One-sided where k is 0 or n: then the bound alone has the coverage, as in "59 clean runs claim less than 5
/// %".
struct Interval95 {
  double low = 0.0, high = 1.0;
};
Interval95 clopper_pearson_95(std::size_t k, std::size_t n);

/// Step-down rule of Holm (1979): true for each hypothesis that is rejected while the probability of any
/// false rejection stays <= alpha. NaN p-values are never rejected but count as hypotheses.
std::vector<bool> holm(std::span<const double> p_values, double alpha);

}  // namespace forcegate
