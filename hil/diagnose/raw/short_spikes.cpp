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

std::optional<ShortSpike> spike_of(const std::vector<double>& U, const Allowance& allowance, std::size_t begin, std::size_t length, bool any_course) {
  constexpr double kFalls = 0.75, kBack = 0.15, kClimbed = 0.2;  // of the peak
  const std::size_t end = begin + length;
  const double before = median_of_three(&U[begin - kAround]), after = median_of_three(&U[end]);
  const double allowed = allowance.between(begin - kAround, end + kAround);
  if (!std::isfinite(before + after + allowed)) return std::nullopt;
  const auto level = [&](std::size_t k) { return before + (after - before) * static_cast<double>(k - begin + 1) / static_cast<double>(length + 1); };
  ShortSpike out{begin, length};
  double highest = 0.0, lowest = 0.0;
  for (std::size_t k = begin; k < end; ++k) {
    highest = std::max(highest, U[k] - level(k));
    lowest = std::min(lowest, U[k] - level(k));
  }
  out.peak_V = std::max(highest, -lowest);
  // nothing that the force does jumps up and down within a few samples while the reference is still
  const bool to_the_last = std::abs(U[end - 1] - level(end - 1)) > 0.5 * allowed;
  out.both_ways = std::min(highest, -lowest) > allowed && to_the_last;
  if (any_course && !to_the_last) return std::nullopt;
  const double sign = U[begin] > level(begin) ? 1.0 : -1.0;
  double last = 0.0;
  for (std::size_t k = begin; k < end; ++k) {
    const double off = sign * (U[k] - level(k));
    if (!out.both_ways && !any_course && (!(off > 0.5 * allowed) || (k > begin && off > last + 0.5 * allowed))) return std::nullopt;
    last = off;
  }
  const bool comes_back = std::abs(after - before) < kBack * out.peak_V + allowed && std::abs(U[end] - after) < kBack * out.peak_V + allowed;
  const bool climbed = std::abs(U[begin - 1] - before) > kClimbed * out.peak_V;  // what the samples before it climb to is a peak
  if (out.peak_V < 2.0 * allowed || (!out.both_ways && !any_course && last > kFalls * out.peak_V) || !comes_back || climbed) return std::nullopt;
  return out;
}

// `any_course`: those to one side need not fall, nor be over within 40 ms.
std::vector<ShortSpike> spikes_of(const std::vector<double>& t_s, const std::vector<double>& U, const Allowance& allowance, bool any_course) {
  std::vector<ShortSpike> out;
  for (std::size_t i = kAround; i + kLongestSpike + kAround < U.size(); ++i) {
    if (!(std::abs(U[i] - U[i - 1]) > allowance.between(i - 1, i + 1))) continue;
    for (std::size_t tried = kShortest; tried <= kLongestSpike; ++tried) {
      const std::size_t length = any_course ? kShortest + kLongestSpike - tried : tried;
      const std::optional<ShortSpike> spike = spike_of(U, allowance, i, length, any_course);
      if (!spike || (!spike->both_ways && !any_course && t_s[i + length] - t_s[i] > kLongest_s)) continue;
      out.push_back(*spike);
      i += length;
      break;
    }
  }
  return out;
}

}  // namespace

std::vector<ShortSpike> find_short_spikes(const std::vector<double>& t_s, const std::vector<double>& F, const std::vector<double>& U, const SpikeScales& scales) {
  constexpr std::ptrdiff_t kSeveral = 3;
  const Allowance allowance{F, scales};
  std::vector<ShortSpike> out = spikes_of(t_s, U, allowance, false);
  // what throws samples up and down throws some of them to one side only
  return std::ranges::count_if(out, &ShortSpike::both_ways) < kSeveral ? out : spikes_of(t_s, U, allowance, true);
}

}  // namespace forcegate::diagnose
