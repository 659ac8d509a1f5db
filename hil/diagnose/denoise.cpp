#include "hil/diagnose/denoise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kReach[] = {2, 4, 8, 16, 32};
constexpr std::size_t kLongest = 32, kBlock = 2048;
constexpr double kAgree = 1.7;

// Weight of a sample k away from the centre of a parabola over 2m+1 samples.
double weight(std::size_t m_size, std::size_t k_size) {
  const double m = static_cast<double>(m_size), k = static_cast<double>(k_size);
  return 3.0 * (3.0 * m * m + 3.0 * m - 1.0 - 5.0 * k * k) /
         ((2.0 * m - 1.0) * (2.0 * m + 1.0) * (2.0 * m + 3.0));
}

}  // namespace

std::vector<double> smooth_within_noise(std::span<const double> x, double sigma) {
  std::vector<double> out(x.begin(), x.end());
  const std::size_t n = x.size();
  if (!(sigma > 0.0) || n < 2 * kLongest + 1) return out;
  std::vector<double> low(kBlock), high(kBlock), estimate(kBlock);
  std::vector<char> open(kBlock);
  for (std::size_t begin = kReach[0]; begin + kReach[0] < n; begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, n - kReach[0]);
    for (std::size_t i = begin; i < end; ++i) {
      low[i - begin] = x[i] - kAgree * sigma;
      high[i - begin] = x[i] + kAgree * sigma;
      open[i - begin] = 1;
    }
    for (const std::size_t m : kReach) {
      const std::size_t from = std::max(begin, m), to = std::min(end, n - m);
      if (from >= to) break;
      const double centre = weight(m, 0), spread = kAgree * sigma * std::sqrt(centre);
      for (std::size_t i = from; i < to; ++i) estimate[i - begin] = centre * x[i];
      for (std::size_t k = 1; k <= m; ++k) {
        const double w = weight(m, k);
        for (std::size_t i = from; i < to; ++i) estimate[i - begin] += w * (x[i - k] + x[i + k]);
      }
      bool any = false;
      for (std::size_t i = from; i < to; ++i) {
        const std::size_t j = i - begin;
        if (open[j] == 0) continue;
        const double l = std::max(low[j], estimate[j] - spread), h = std::min(high[j], estimate[j] + spread);
        if (!std::isfinite(estimate[j]) || !(l <= h)) {
          open[j] = 0;
          continue;
        }
        low[j] = l;
        high[j] = h;
        out[i] = estimate[j];
        any = true;
      }
      for (std::size_t i = begin; i < end; ++i)
        if (i < from || i >= to) open[i - begin] = 0;
      if (!any) break;
    }
  }
  return out;
}

}  // namespace forcegate::diagnose
