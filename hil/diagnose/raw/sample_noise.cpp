#include "hil/diagnose/raw/sample_noise.h"

#include <algorithm>
#include <cmath>

#include "hil/model/rows.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kFewestValues = 8;

std::vector<double> values_of(const std::vector<double>& x) {
  std::vector<double> v;
  const std::size_t stride = std::max<std::size_t>(1, x.size() / 6000);
  for (std::size_t i = 0; i < x.size(); i += stride)
    if (std::isfinite(x[i])) v.push_back(x[i]);
  std::sort(v.begin(), v.end());
  v.erase(std::unique(v.begin(), v.end()), v.end());
  return v;
}

}  // namespace

double white_noise(const std::vector<double>& x) {
  std::vector<double> d;
  const std::size_t stride = std::max<std::size_t>(1, x.size() / 20000);
  for (std::size_t i = 2; i + 2 < x.size(); i += stride) {
    const double v = x[i - 2] - 4.0 * x[i - 1] + 6.0 * x[i] - 4.0 * x[i + 1] + x[i + 2];
    if (std::isfinite(v)) d.push_back(std::abs(v));
  }
  const double median = quantile(std::move(d), 0.5);
  return std::isfinite(median) ? 1.4826 * median / std::sqrt(70.0) : 0.0;
}

double restless_noise(std::span<const double> t_s, const std::vector<double>& x) {
  constexpr std::size_t kSide = 4, kMost = 8000;
  std::vector<double> d;
  const std::size_t n = std::min(t_s.size(), x.size()), stride = std::max<std::size_t>(1, n / kMost);
  for (std::size_t i = kSide; i + kSide < n; i += stride) {
    double left = x[i], norm2 = 1.0;
    for (std::size_t k = i - kSide; k <= i + kSide; ++k) {
      if (k == i) continue;
      double weight = 1.0;
      for (std::size_t j = i - kSide; j <= i + kSide; ++j)
        if (j != i && j != k) weight *= (t_s[i] - t_s[j]) / (t_s[k] - t_s[j]);
      left -= weight * x[k];
      norm2 += weight * weight;
    }
    if (const double v = std::abs(left) / std::sqrt(norm2); std::isfinite(v)) d.push_back(v);
  }
  const double median = quantile(std::move(d), 0.5);
  return std::isfinite(median) ? 1.4826 * median : 0.0;
}

bool shows_few_values(const std::vector<double>& x) { return values_of(x).size() < kFewestValues; }

double value_step(const std::vector<double>& x) {
  const std::vector<double> v = values_of(x);
  if (v.size() < kFewestValues) return 0.0;
  std::vector<double> gaps;
  for (std::size_t i = 1; i < v.size(); ++i) gaps.push_back(v[i] - v[i - 1]);
  // the smallest too: where the levels of a staircase lie far apart most gaps are theirs
  for (const double step : {quantile(gaps, 0.2), *std::ranges::min_element(gaps)}) {
    const auto fits = [&](double gap) { return std::round(gap / step) >= 1.0 && std::abs(gap / step - std::round(gap / step)) < 0.12; };
    if (step > 0.0 && static_cast<double>(std::ranges::count_if(gaps, fits)) > 0.9 * static_cast<double>(gaps.size())) return step;
  }
  return 0.0;
}

bool are_set_levels(const std::vector<double>& F_N, double step_N, const std::vector<double>& U_V, double gain_V_per_N) {
  constexpr std::size_t kFewest = 8;
  constexpr double kGoesOn = 0.5, kMostly = 0.5, kOfRounding = 0.5;  // of a step; of the samples; of what rounding would leave
  std::vector<double> beside_force;
  std::size_t all = 0;
  for (std::size_t i = 2; i + 2 < F_N.size(); ++i, ++all) {
    bool goes_on = true;
    for (std::size_t k = i - 1; k <= i + 2; ++k) goes_on = goes_on && std::abs(F_N[k] - F_N[k - 1]) > kGoesOn * step_N;
    if (!goes_on) continue;
    const auto e = [&](std::size_t k) { return U_V[k] - gain_V_per_N * F_N[k]; };
    if (const double v = e(i - 2) - 4.0 * e(i - 1) + 6.0 * e(i) - 4.0 * e(i + 1) + e(i + 2); std::isfinite(v)) beside_force.push_back(std::abs(v));
  }
  if (beside_force.size() < kFewest || static_cast<double>(beside_force.size()) < kMostly * static_cast<double>(all)) return false;
  const double noise_V = 1.4826 * quantile(std::move(beside_force), 0.5) / std::sqrt(70.0);
  return noise_V < kOfRounding * std::abs(gain_V_per_N) * step_N / std::sqrt(12.0);
}

}  // namespace forcegate::diagnose
