#include "hil/diagnose/raw/denoise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kReach[] = {2, 4, 8, 16, 32};
constexpr std::size_t kLongest = 32, kBlock = 128, kTogether = 4;

// Weight of a sample k away from the centre of a parabola over 2m+1 samples.
double weight(std::size_t m_size, std::size_t k_size) {
  const double m = static_cast<double>(m_size), k = static_cast<double>(k_size);
  return 3.0 * (3.0 * m * m + 3.0 * m - 1.0 - 5.0 * k * k) /
         ((2.0 * m - 1.0) * (2.0 * m + 1.0) * (2.0 * m + 3.0));
}

struct Window {
  std::size_t reach;
  std::array<double, kLongest + 1> weight;
};

std::array<Window, std::size(kReach)> windows() {
  std::array<Window, std::size(kReach)> out{};
  for (std::size_t w = 0; w < out.size(); ++w) {
    out[w].reach = kReach[w];
    for (std::size_t k = 0; k <= kReach[w]; ++k) out[w].weight[k] = weight(kReach[w], k);
  }
  return out;
}

// Centres of the parabolas around x[0] .. x[n - 1]. Every sum runs from the middle outwards.
void fit_parabolas(const Window& window, const double* x, std::size_t n, double* __restrict estimate) {
  const auto& w = window.weight;
  const auto pair = [](const double* at, std::size_t k) { return *(at - k) + *(at + k); };
  for (std::size_t i = 0; i < n; ++i) estimate[i] = w[0] * x[i];
  std::size_t k = 1;
  for (; k + kTogether <= window.reach + 1; k += kTogether)
    for (std::size_t i = 0; i < n; ++i)
      estimate[i] = (((estimate[i] + w[k] * pair(x + i, k)) + w[k + 1] * pair(x + i, k + 1)) +
                     w[k + 2] * pair(x + i, k + 2)) +
                    w[k + 3] * pair(x + i, k + 3);
  for (; k <= window.reach; ++k)
    for (std::size_t i = 0; i < n; ++i) estimate[i] += w[k] * pair(x + i, k);
}

}  // namespace

std::vector<double> smooth_within_noise(std::vector<double> x, double sigma, double* left, double agree) {
  const std::size_t n = x.size();
  if (left != nullptr) *left = std::max(0.0, sigma);
  if (!(sigma > 0.0) || n < 2 * kLongest + 1) return x;
  const auto window = windows();
  std::array<double, kBlock> low, high, estimate, share;  // share of the variance of one sample
  double shares = 2.0 * static_cast<double>(kReach[0]);
  std::array<char, kBlock> open;
  // the block as it was, from kLongest before it to kLongest behind it
  std::array<double, kLongest + kBlock + kLongest> seen{};
  const double* const block = seen.data() + kLongest;
  std::copy_n(x.begin(), kReach[0], seen.end() - kReach[0] - kLongest);
  for (std::size_t begin = kReach[0]; begin + kReach[0] < n; begin += kBlock) {
    std::copy_n(seen.begin() + kBlock, kLongest, seen.begin());
    std::copy_n(x.begin() + static_cast<std::ptrdiff_t>(begin), std::min(kBlock + kLongest, n - begin),
                seen.begin() + kLongest);
    // from .. to: samples of the block among which some are open to a wider window yet
    std::size_t from = 0, to = std::min(kBlock, n - kReach[0] - begin);
    for (std::size_t j = from; j < to; ++j) {
      low[j] = block[j] - agree * sigma;
      high[j] = block[j] + agree * sigma;
      open[j] = 1;
      share[j] = 1.0;
    }
    const std::size_t in_block = to;
    for (const Window& w : window) {
      from = std::max(from, std::max(w.reach, begin) - begin);
      to = std::min(to, std::max(n - w.reach, begin) - begin);
      if (from >= to) break;
      fit_parabolas(w, block + from, to - from, estimate.data() + from);
      const double spread = agree * sigma * std::sqrt(w.weight[0]);
      std::size_t first_open = to, last_open = from;
      for (std::size_t j = from; j < to; ++j) {
        if (open[j] == 0) continue;
        const double l = std::max(low[j], estimate[j] - spread), h = std::min(high[j], estimate[j] + spread);
        if (!std::isfinite(estimate[j]) || !(l <= h)) {
          open[j] = 0;
          continue;
        }
        low[j] = l;
        high[j] = h;
        x[begin + j] = estimate[j];
        share[j] = w.weight[0];
        first_open = std::min(first_open, j);
        last_open = j + 1;
      }
      from = first_open;
      to = last_open;
    }
    for (std::size_t j = 0; j < in_block; ++j) shares += share[j];
  }
  if (left != nullptr) *left = sigma * std::sqrt(shares / static_cast<double>(n));
  return x;
}

}  // namespace forcegate::diagnose
