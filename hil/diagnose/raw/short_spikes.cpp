#include "hil/diagnose/raw/short_spikes.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kShortest = 2, kAround = 3;  // samples
constexpr double kLongest_s = 0.04;

double median_of_three(const double* x) { return std::max(std::min(x[0], x[1]), std::min(std::max(x[0], x[1]), x[2])); }

struct Allowance {
  const std::vector<double>& F;
  SpikeScales scales;
  /// What the output may do between two samples: noise, and half as much again as the force does.
  double between(std::size_t begin, std::size_t end) const {
    const auto [low, high] = std::minmax_element(F.begin() + static_cast<std::ptrdiff_t>(begin), F.begin() + static_cast<std::ptrdiff_t>(end));
    return scales.quiet_V + 1.5 * scales.gain_V_per_N * (*high - *low);
  }
};

std::optional<ShortSpike> spike_of(const std::vector<double>& U, const Allowance& allowance, std::size_t begin, std::size_t length) {
  constexpr double kFalls = 0.75, kBack = 0.15, kClimbed = 0.2;  // of the peak
  const std::size_t end = begin + length;
  const double before = median_of_three(&U[begin - kAround]), after = median_of_three(&U[end]);
  const double allowed = allowance.between(begin - kAround, end + kAround);
  if (!std::isfinite(before + after + allowed)) return std::nullopt;
  const auto level = [&](std::size_t k) { return before + (after - before) * static_cast<double>(k - begin + 1) / static_cast<double>(length + 1); };
  const double sign = U[begin] > level(begin) ? 1.0 : -1.0;
  ShortSpike out{begin, length, 0.0};
  double last = 0.0;
  for (std::size_t k = begin; k < end; ++k) {
    const double off = sign * (U[k] - level(k));
    if (!(off > 0.5 * allowed) || (k > begin && off > last + 0.5 * allowed)) return std::nullopt;
    out.peak_V = std::max(out.peak_V, off);
    last = off;
  }
  const bool comes_back = std::abs(after - before) < kBack * out.peak_V + allowed && std::abs(U[end] - after) < kBack * out.peak_V + allowed;
  const bool climbed = std::abs(U[begin - 1] - before) > kClimbed * out.peak_V;  // what the samples before it climb to is a peak
  if (out.peak_V < 2.0 * allowed || last > kFalls * out.peak_V || !comes_back || climbed) return std::nullopt;
  return out;
}

}  // namespace

std::vector<ShortSpike> find_short_spikes(const std::vector<double>& t_s, const std::vector<double>& F, const std::vector<double>& U, const SpikeScales& scales) {
  std::vector<ShortSpike> out;
  const Allowance allowance{F, scales};
  for (std::size_t i = kAround; i + kLongestSpike + kAround < U.size(); ++i) {
    if (!(std::abs(U[i] - U[i - 1]) > allowance.between(i - 1, i + 1))) continue;
    for (std::size_t length = kShortest; length <= kLongestSpike; ++length) {
      if (t_s[i + length] - t_s[i] > kLongest_s) break;
      const std::optional<ShortSpike> spike = spike_of(U, allowance, i, length);
      if (!spike) continue;
      out.push_back(*spike);
      i += length;
      break;
    }
  }
  return out;
}

}  // namespace forcegate::diagnose
