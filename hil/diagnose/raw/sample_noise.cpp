#include "hil/diagnose/raw/sample_noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/base/evenly_chosen.h"
#include "hil/base/quantile.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kFewestValues = 8;

std::vector<double> values_of(const std::vector<double>& x) {
  std::vector<double> v;
  EvenlyChosen choice(x.size(), 6000);
  for (const double value : x)
    if (std::isfinite(value) && choice.next()) v.push_back(value);
  std::sort(v.begin(), v.end());
  v.erase(std::unique(v.begin(), v.end()), v.end());
  return v;
}

}  // namespace

double white_noise(const std::vector<double>& x, std::size_t most) {
  constexpr double kHardlyAny = 0.02;  // of the windows are complete
  std::vector<double> d;
  const std::size_t stride = std::max<std::size_t>(1, x.size() / std::max<std::size_t>(1, most));
  double asked = 0.0;
  for (std::size_t i = 2; i + 2 < x.size(); i += stride, asked += 1.0) {
    const double v = x[i - 2] - 4.0 * x[i - 1] + 6.0 * x[i] - 4.0 * x[i + 1] + x[i + 2];
    if (std::isfinite(v)) d.push_back(std::abs(v));
  }
  if (static_cast<double>(d.size()) < kHardlyAny * asked) return noise_between_missing(x);
  return deviation_of_magnitudes(std::move(d)) / std::sqrt(70.0);
}

double noise_between_missing(const std::vector<double>& x) {
  constexpr std::size_t kWindow = 5, kReach = 2 * kWindow, kMost = 20000;
  std::vector<std::size_t> there;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (std::isfinite(x[i])) there.push_back(i);
  std::vector<double> d;
  const std::size_t stride = std::max<std::size_t>(1, there.size() / kMost);
  for (std::size_t first = 0; first + kWindow <= there.size(); first += stride) {
    if (there[first + kWindow - 1] - there[first] > kReach) continue;
    double sum = 0.0, norm2 = 0.0;
    for (std::size_t k = first; k < first + kWindow; ++k) {
      double weight = 1.0;
      for (std::size_t j = first; j < first + kWindow; ++j)
        if (j != k) weight /= static_cast<double>(there[k]) - static_cast<double>(there[j]);
      sum += weight * x[there[k]];
      norm2 += weight * weight;
    }
    d.push_back(std::abs(sum) / std::sqrt(norm2));
  }
  return deviation_of_magnitudes(std::move(d));
}

namespace {

double restless_noise_of(std::span<const double> t_s, const std::vector<double>& x, std::size_t& asked, std::size_t& complete) {
  constexpr std::size_t kSide = 4, kMost = 8000;
  std::vector<double> d;
  const std::size_t n = std::min(t_s.size(), x.size()), stride = std::max<std::size_t>(1, n / kMost);
  for (std::size_t i = kSide; i + kSide < n; i += stride, ++asked) {
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
  complete = d.size();
  return deviation_of_magnitudes(std::move(d));
}

}  // namespace

double restless_noise(std::span<const double> t_s, const std::vector<double>& x) {
  constexpr std::size_t kHardlyAny = 50;  // one window in so many is complete
  std::size_t asked = 0, complete = 0;
  const double noise = restless_noise_of(t_s, x, asked, complete);
  if (complete * kHardlyAny >= asked) return noise;
  std::vector<double> there_s, there;
  for (std::size_t i = 0; i < std::min(t_s.size(), x.size()); ++i)
    if (std::isfinite(x[i])) there_s.push_back(t_s[i]), there.push_back(x[i]);
  return restless_noise_of(there_s, there, asked, complete);
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

double left_of_dithered_step(double step, double noise) {
  constexpr int kHarmonics = 30;
  if (!(step > 0.0)) return 0.0;
  double sum = 0.0;
  for (int k = 1; k <= kHarmonics; ++k) {
    const double phase = 2.0 * std::numbers::pi * k * noise / step;
    sum += std::exp(-phase * phase) / (k * k);
  }
  return step / std::numbers::pi * std::sqrt(0.5 * sum);
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
  const double noise_V = deviation_of_magnitudes(std::move(beside_force)) / std::sqrt(70.0);
  return noise_V < kOfRounding * std::abs(gain_V_per_N) * step_N / std::sqrt(12.0);
}

}  // namespace forcegate::diagnose
