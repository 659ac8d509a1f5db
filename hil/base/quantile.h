#pragma once
// Order statistics of a few values.

#include <array>
#include <utility>
#include <vector>

namespace forcegate {

/// q-quantile (0..1): the finite value next to it, the upper of two as near. NaN when there are none.
double quantile(std::vector<double> values, double q);
/// Two of them, low_q <= high_q.
std::array<double, 2> quantiles(std::vector<double> values, double low_q, double high_q);

inline double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

/// Standard deviation of normal noise from magnitudes of it, most of which are no outliers: 1.4826 times their median. 0 when there are none.
double deviation_of_magnitudes(std::vector<double> magnitudes);

}  // namespace forcegate
