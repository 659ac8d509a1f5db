#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "golden/compare/tube.h"

namespace forcegate {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kBlocks = 16;

struct Sums {
  double slope_difference = 0.0;  // sum of g' (g - x)
  double slope_squared = 0.0;     // sum of g'^2
};

// tested[i + shift] against golden[i]; slope in signal units per sample.
std::array<Sums, kBlocks> block_sums(std::span<const float> g, std::span<const float> x,
                                     std::ptrdiff_t shift) {
  std::array<Sums, kBlocks> out{};
  const auto n = static_cast<std::ptrdiff_t>(std::min(g.size(), x.size()));
  const std::ptrdiff_t first = std::max<std::ptrdiff_t>(1, -shift);
  const std::ptrdiff_t last = std::min(n - 1, n - shift);
  if (last <= first) return out;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    const auto low =
        first + (last - first) * static_cast<std::ptrdiff_t>(b) / static_cast<std::ptrdiff_t>(kBlocks);
    const auto high =
        first + (last - first) * static_cast<std::ptrdiff_t>(b + 1) / static_cast<std::ptrdiff_t>(kBlocks);
    double sd = 0.0, ss = 0.0;
    for (std::ptrdiff_t i = low; i < high; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double slope = 0.5 * (static_cast<double>(g[k + 1]) - static_cast<double>(g[k - 1]));
      sd += slope * (static_cast<double>(g[k]) - static_cast<double>(x[static_cast<std::size_t>(i + shift)]));
      ss += slope * slope;
    }
    out[b] = {sd, ss};
  }
  return out;
}

double total_lag(const std::array<Sums, kBlocks>& blocks) {
  double sd = 0.0, ss = 0.0;
  for (const Sums& b : blocks) {
    sd += b.slope_difference;
    ss += b.slope_squared;
  }
  return ss > 0.0 ? sd / ss : kNone;
}

}  // namespace

LagEstimate estimate_lag(const SampledTrace& golden, const SampledTrace& tested, double search_s) {
  if (golden.value.size() < 3 || tested.value.size() < 3) return {kNone, kNone};
  const auto search = static_cast<std::ptrdiff_t>(search_s / golden.step_s + 0.5);
  std::ptrdiff_t shift = 0;
  std::array<Sums, kBlocks> blocks{};
  double step = kNone;
  for (int round = 0; round < 8; ++round) {
    blocks = block_sums(golden.value, tested.value, shift);
    step = total_lag(blocks);
    if (!std::isfinite(step)) return {kNone, kNone};
    const auto whole = static_cast<std::ptrdiff_t>(std::lround(std::clamp(step, -1e6, 1e6)));
    const std::ptrdiff_t next = std::clamp(shift + whole, -search, search);
    if (next == shift) break;
    shift = next;
  }
  double mean = 0.0, square = 0.0;
  int n = 0;
  for (const Sums& b : blocks) {
    if (!(b.slope_squared > 0.0)) continue;
    const double lag = b.slope_difference / b.slope_squared;
    ++n;
    const double d = lag - mean;
    mean += d / n;
    square += d * (lag - mean);
  }
  const double u = n > 1 ? std::sqrt(square / (n - 1) / n) : kNone;
  return {(static_cast<double>(shift) + step) * golden.step_s, u * golden.step_s};
}

}  // namespace forcegate
