#include "hil/gate/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace forcegate {
namespace {

// Regularised incomplete beta function by the continued fraction of Lentz (DLMF 8.17.22).
double incomplete_beta(double a, double b, double x) {
  if (x <= 0.0) return 0.0;
  if (x >= 1.0) return 1.0;
  if (x > (a + 1.0) / (a + b + 2.0)) return 1.0 - incomplete_beta(b, a, 1.0 - x);
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x)) /
      a;
  constexpr double kTiny = 1e-300;
  double f = 1.0, c = 1.0, d = 0.0;
  for (int i = 0; i <= 500; ++i) {
    const int m = i / 2;
    double numerator = 1.0;
    if (i > 0 && i % 2 == 0)
      numerator = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
    else if (i > 0)
      numerator = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
    d = 1.0 + numerator * d;
    if (std::fabs(d) < kTiny) d = kTiny;
    d = 1.0 / d;
    c = 1.0 + numerator / c;
    if (std::fabs(c) < kTiny) c = kTiny;
    f *= c * d;
    if (std::fabs(1.0 - c * d) < 1e-14) break;
  }
  return front * (f - 1.0);
}

}  // namespace

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

double student_cdf(double t, double dof) {
  if (!(dof > 0.0) || dof > 1e6) return normal_cdf(t);
  if (!std::isfinite(t)) return std::isnan(t) ? t : (t > 0 ? 1.0 : 0.0);
  const double tail = 0.5 * incomplete_beta(dof / 2.0, 0.5, dof / (dof + t * t));
  return t > 0 ? 1.0 - tail : tail;
}

double coverage_factor(double coverage, double dof) {
  double low = 0.0, high = 1e6;
  for (int i = 0; i < 200 && high - low > 1e-12 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (2.0 * student_cdf(middle, dof) - 1.0 < coverage ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double chi_square_99(double dof) {
  const double c = 2.0 / (9.0 * dof), root = 1.0 - c + 2.3263479 * std::sqrt(c);
  return dof * root * root * root;
}

Moments moments(std::span<const double> values) {
  Moments m;
  double sum = 0.0;
  for (const double v : values)
    if (std::isfinite(v)) {
      sum += v;
      ++m.n;
    }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  m.mean = m.n > 0 ? sum / static_cast<double>(m.n) : nan;
  double squares = 0.0;
  for (const double v : values)
    if (std::isfinite(v)) squares += (v - m.mean) * (v - m.mean);
  m.sd = m.n > 1 ? std::sqrt(squares / static_cast<double>(m.n - 1)) : nan;
  return m;
}

double sample_quantile(std::vector<double> values, double p) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double at = std::clamp(p, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const std::size_t high = std::min(low + 1, values.size() - 1);
  return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
}

QuantileBound quantile_bound_95(std::vector<double> values, double p) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return {std::numeric_limits<double>::quiet_NaN(), false};
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  // P(Bin(n, p) <= r - 1) = I_{1-p}(n - r + 1, r), and it grows with r.
  const auto confidence = [&](std::size_t r) {
    return incomplete_beta(n - static_cast<double>(r) + 1.0, static_cast<double>(r), 1.0 - p);
  };
  std::size_t r = values.size();
  if (confidence(r) < 0.95) return {values.back(), false};
  while (r > 1 && confidence(r - 1) >= 0.95) --r;
  return {values[r - 1], true};
}

Interval95 clopper_pearson_95(std::size_t k, std::size_t n) {
  Interval95 out;
  if (n == 0 || k > n) return out;
  const double tail = k == 0 || k == n ? 0.05 : 0.025;
  // p so that the regularised incomplete beta function I_p(a, b) = target.
  const auto solve = [](double a, double b, double target) {
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 200; ++i) {
      const double middle = 0.5 * (low + high);
      (incomplete_beta(a, b, middle) < target ? low : high) = middle;
    }
    return 0.5 * (low + high);
  };
  const auto hits = static_cast<double>(k), misses = static_cast<double>(n - k);
  if (k > 0) out.low = solve(hits, misses + 1.0, tail);
  if (k < n) out.high = solve(hits + 1.0, misses, 1.0 - tail);
  return out;
}

std::vector<bool> holm(std::span<const double> p_values, double alpha) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [&](std::size_t i) { return std::isnan(p_values[i]) ? 2.0 : p_values[i]; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  std::vector<bool> rejected(p_values.size(), false);
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (!(key(order[k]) <= alpha / static_cast<double>(order.size() - k))) break;
    rejected[order[k]] = true;
  }
  return rejected;
}

}  // namespace forcegate
