#include "hil/base/quantile.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace forcegate {

double quantile(std::vector<double> values, double q) { return quantiles(std::move(values), q, q).front(); }

std::array<double, 2> quantiles(std::vector<double> values, double low_q, double high_q) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return {kNone, kNone};
  const auto place = [&](double q) {
    return values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  };
  const auto low = place(low_q), high = place(high_q);
  std::nth_element(values.begin(), low, values.end());
  if (high > low) std::nth_element(low + 1, high, values.end());
  return {*low, *high};
}

double deviation_of_magnitudes(std::vector<double> magnitudes) {
  constexpr double kOfNormal = 1.4826;
  const double typical = median(std::move(magnitudes));
  return std::isfinite(typical) ? kOfNormal * typical : 0.0;
}

}  // namespace forcegate
