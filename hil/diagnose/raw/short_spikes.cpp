#include "hil/diagnose/raw/short_spikes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "hil/base/quantile.h"
#include "hil/diagnose/raw/range_ends.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kShortest = 2, kAround = 3;  // samples
constexpr double kLongest_s = 0.04;

double median_of_three(const double* x) { return std::max(std::min(x[0], x[1]), std::min(std::max(x[0], x[1]), x[2])); }

constexpr std::size_t kFewestFalls = 5;
constexpr double kNearlyAll = 0.9, kFarApart = 10.0;  // of the spikes; of what counts as one level

struct Allowance {
  const std::vector<double>& F;
  SpikeScales scales;
  /// What the output may do between two samples: noise, and half as much again as the force does.
  double between(std::size_t begin, std::size_t end) const {
    const auto [low, high] = spread_of_present(std::span(F).subspan(begin, end - begin));
    return scales.quiet_V + 1.5 * scales.gain_V_per_N * (high - low);
  }
};

std::optional<ShortSpike> spike_of(const std::vector<double>& U, const Allowance& allowance, std::size_t begin, std::size_t length, bool any_course) {
  constexpr double kFalls = 0.75, kBack = 0.15, kClimbed = 0.2;  // of the peak
  constexpr double kAbove = 2.0, kFilteredAbove = 1.3;            // times what is allowed
  const std::size_t end = begin + length;
  const double before = median_of_three(&U[begin - kAround]), after = median_of_three(&U[end]);
  const double allowed = allowance.between(begin - kAround, end + kAround);
  if (!std::isfinite(before + after + allowed)) return std::nullopt;
  const auto level = [&](std::size_t k) { return before + (after - before) * static_cast<double>(k - begin + 1) / static_cast<double>(length + 1); };
  ShortSpike out{.begin = begin, .length = length, .level_V = 0.5 * (before + after)};
  double highest = 0.0, lowest = 0.0;
  for (std::size_t k = begin; k < end; ++k) {
    highest = std::max(highest, U[k] - level(k));
    lowest = std::min(lowest, U[k] - level(k));
  }
  out.peak_V = std::max(highest, -lowest);
  out.up = highest > -lowest;
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
  const bool must_fall = !out.both_ways && !any_course;  // what has the course of a filter's answer may be smaller
  if (out.peak_V < (must_fall ? kFilteredAbove : kAbove) * allowed || (must_fall && last > kFalls * out.peak_V) || !comes_back || climbed) return std::nullopt;
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
      if (!(spike->peak_V > kAboveAround * scatter_around(U, i + length / 2))) break;
      out.push_back(*spike);
      i += length;
      break;
    }
  }
  return out;
}

// Half a turn of a mount or a cable that rings: the next half turn on one side leads the other way, and the one beyond it back.
bool rings(const std::vector<double>& U, const ShortSpike& spike) {
  constexpr double kOther = 0.4, kSame = 0.3;  // of the peak: a swing that fades by half a turn
  const auto n = static_cast<std::ptrdiff_t>(U.size()), length = static_cast<std::ptrdiff_t>(spike.length), begin = static_cast<std::ptrdiff_t>(spike.begin);
  const double sign = spike.up ? 1.0 : -1.0;
  const auto goes_on = [&](std::ptrdiff_t from, std::ptrdiff_t step) {
    const auto at = [&](std::ptrdiff_t k) { return U[static_cast<std::size_t>(from + step * k)]; };
    const std::ptrdiff_t turns = 6 * length, last = from + step * (turns - 1);
    if (from < 0 || from >= n || last < 0 || last >= n) return false;
    double level = 0.0, other = 0.0, same = 0.0;
    for (std::ptrdiff_t k = 0; k < turns; ++k) level += at(k) / static_cast<double>(turns);
    for (std::ptrdiff_t k = 0; k < 2 * length; ++k) other = std::max(other, -sign * (at(k) - level));
    for (std::ptrdiff_t k = length; k < 4 * length; ++k) same = std::max(same, sign * (at(k) - level));
    return other > kOther * spike.peak_V && same > kSame * spike.peak_V;
  };
  return goes_on(begin + length, 1) || goes_on(begin - 1, -1);
}

constexpr std::ptrdiff_t kSeveral = 3;

// A stretch of noise jumps on both sides of an excursion as far as there.
bool stands_alone(const std::vector<double>& U, const Allowance& allowance, const ShortSpike& spike) {
  constexpr std::size_t kFar = 100;
  constexpr double kAsFar = 0.3;
  const std::size_t begin = std::max<std::size_t>(spike.begin, kFar) - kFar, end = std::min(spike.begin + spike.length + kFar, U.size() - 1);
  for (std::size_t i = begin; i < end; ++i) {
    if (i + 1 >= spike.begin && i < spike.begin + spike.length) continue;
    if (std::abs(U[i + 1] - U[i]) > allowance.between(i, i + 2) + kAsFar * spike.peak_V) return false;
  }
  return true;
}

void add_jumps(const std::vector<ShortSpike>& spikes, std::vector<Jump>& to) {
  for (const ShortSpike& s : spikes) to.push_back({s.level_V, s.level_V + (s.up ? s.peak_V : -s.peak_V)});
}

}  // namespace

std::vector<Jump> excursions(const std::vector<double>& t_s, const std::vector<double>& F, const std::vector<double>& U, const SpikeScales& scales) {
  const Allowance allowance{F, scales};
  std::vector<ShortSpike> spikes = spikes_of(t_s, U, allowance, true);
  std::erase_if(spikes, [&](const ShortSpike& s) { return !stands_alone(U, allowance, s); });
  std::vector<Jump> out;
  add_jumps(spikes, out);
  return out;
}

bool go_back_and_forth(std::span<const Jump> jumps, double near_V) {
  constexpr std::size_t kFewest = 4;
  constexpr double kMost = 0.6;
  if (jumps.size() < kFewest) return false;
  std::vector<Jump> sorted(jumps.begin(), jumps.end());
  std::ranges::sort(sorted, {}, &Jump::from_V);
  const auto leads_back = [&](const Jump& there) {
    const auto first = std::ranges::upper_bound(sorted, there.to_V - near_V, {}, &Jump::from_V), last = std::ranges::lower_bound(sorted, there.to_V + near_V, {}, &Jump::from_V);
    return std::any_of(first, last, [&](const Jump& back) { return std::abs(back.to_V - there.from_V) < near_V; });
  };
  return static_cast<double>(std::ranges::count_if(jumps, leads_back)) >= kMost * static_cast<double>(jumps.size());
}

std::vector<Jump> jumps_of(const LoneSpikes& spikes) {
  std::vector<Jump> out;
  for (std::size_t k = 0; k < spikes.at.size(); ++k) out.push_back({spikes.level_V[k], spikes.U[spikes.at[k]]});
  return out;
}

bool thrown_at_random(std::span<const Jump> excursions, double near_V) {
  constexpr double kDiffer = 1.5;
  const auto up = std::ranges::count_if(excursions, [](const Jump& jump) { return jump.to_V > jump.from_V; });
  if (up == 0 || up == std::ssize(excursions) || std::ssize(excursions) < kSeveral || go_back_and_forth(excursions, near_V)) return false;
  std::vector<double> size;
  for (const Jump& jump : excursions) size.push_back(std::abs(jump.to_V - jump.from_V));
  const auto [low, high] = quantiles(std::move(size), 0.15, 0.85);
  return high > kDiffer * low;
}

bool fall_to_one_level(const LoneSpikes& spikes, double near_V) {
  if (spikes.at.size() < kFewestFalls) return false;
  double lowest = std::numeric_limits<double>::infinity(), low = lowest, high = -lowest;
  for (const double U : spikes.U)
    if (std::isfinite(U)) lowest = std::min(lowest, U);
  std::size_t falls = 0;
  for (std::size_t k = 0; k < spikes.at.size(); ++k) {
    falls += spikes.U[spikes.at[k]] < lowest + near_V ? 1 : 0;
    low = std::min(low, spikes.level_V[k]);
    high = std::max(high, spikes.level_V[k]);
  }
  return static_cast<double>(falls) >= kNearlyAll * static_cast<double>(spikes.at.size()) && high - low > kFarApart * near_V;
}

std::vector<ShortSpike> find_short_spikes(const std::vector<double>& t_s, const std::vector<double>& F, const std::vector<double>& U, const SpikeScales& scales,
                                          std::span<const Jump> lone) {
  constexpr std::size_t kFewestTails = 6;
  const Allowance allowance{F, scales};
  std::vector<ShortSpike> falling = spikes_of(t_s, U, allowance, false), any = spikes_of(t_s, U, allowance, true);
  for (std::vector<ShortSpike>* found : {&falling, &any})
    std::erase_if(*found, [&](const ShortSpike& s) { return rings(U, s); });
  // what throws samples up and down throws some of them to one side only
  const bool throws = scales.thrown || std::ranges::count_if(falling, &ShortSpike::both_ways) >= kSeveral;
  std::vector<Jump> jumps(lone.begin(), lone.end());
  add_jumps(any, jumps);
  if (throws || thrown_at_random(jumps, scales.quiet_V)) return any;
  // to one side, one or two may be what the contact did
  if (falling.size() < kFewestTails) std::erase_if(falling, [](const ShortSpike& s) { return !s.both_ways; });
  return falling;
}

double scatter_around(const std::vector<double>& U, std::size_t at) {
  constexpr std::size_t kAround = 24, kBeside = 3;
  std::vector<double> second;
  for (std::size_t k = std::max(at, kAround + 1) - kAround; k + 1 < std::min(U.size(), at + kAround); ++k)
    if ((k + kBeside < at || k > at + kBeside) && std::isfinite(U[k - 1] + U[k] + U[k + 1])) second.push_back(std::abs(U[k - 1] - 2.0 * U[k] + U[k + 1]));
  return deviation_of_magnitudes(std::move(second)) / std::sqrt(6.0);
}

bool sit_at_fixed_levels(const LoneSpikes& spikes) {
  const std::vector<double>&U = spikes.U, &level = spikes.level_V;
  constexpr std::size_t kBins = 128, kEnough = 40;
  if (level.size() < kEnough) return false;
  const double low = quantile(U, 0.001), high = quantile(U, 0.999);
  if (!(high > low)) return false;
  std::vector<double> all(kBins, 0.0), jumps(kBins, 0.0);
  const auto bin = [&](double u) {
    return static_cast<std::size_t>(std::clamp((u - low) / (high - low), 0.0, 0.9999) *
                                    static_cast<double>(kBins));
  };
  double n_all = 0.0;
  for (double u : U)
    if (std::isfinite(u)) {
      all[bin(u)] += 1.0;
      n_all += 1.0;
    }
  for (double u : level) jumps[bin(u)] += 1.0;
  std::vector<std::size_t> order(kBins);
  for (std::size_t b = 0; b < kBins; ++b) order[b] = b;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return jumps[a] * (all[b] + 1.0) > jumps[b] * (all[a] + 1.0);
  });
  double covered = 0.0, visited = 0.0;
  for (std::size_t b : order) {
    if (covered >= 0.8 * static_cast<double>(level.size())) break;
    covered += jumps[b];
    visited += all[b];
  }
  return visited < 0.25 * n_all;
}

namespace {

// A bit that is clear goes up and one that is set goes down: which it is changes every `bit_V` of the level, from a zero of the codes that nobody
// told.
bool turn_as_bit_stands(const LoneSpikes& spikes, double bit_V) {
  constexpr int kZeros = 40;
  constexpr double kMost = 0.8;
  double best = 0.0;
  for (int zero = 0; zero < kZeros; ++zero) {
    double agree = 0.0;
    for (std::size_t k = 0; k < spikes.at.size(); ++k) {
      const double periods = spikes.level_V[k] / (2.0 * bit_V) + static_cast<double>(zero) / kZeros;
      const bool is_set = periods - std::floor(periods) >= 0.5, falls = spikes.U[spikes.at[k]] < spikes.level_V[k];
      agree += is_set == falls ? 1.0 : 0.0;
    }
    best = std::max(best, agree);
  }
  return best >= kMost * static_cast<double>(spikes.at.size());
}

}  // namespace

double common_bit_V(const LoneSpikes& spikes, double range_V, double span_V) {
  constexpr std::size_t kEnough = 12;
  constexpr double kMostOfSpan = 4.0;
  if (spikes.at.size() < kEnough) return 0.0;
  std::vector<double> jump, value;
  for (std::size_t k = 0; k < spikes.at.size(); ++k) {
    value.push_back(spikes.U[spikes.at[k]]);
    jump.push_back(std::abs(value.back() - spikes.level_V[k]));
  }
  const double size = quantile(jump, 0.5);
  std::size_t same = 0;
  for (double j : jump) same += std::abs(j - size) < 0.15 * size ? 1 : 0;
  if (static_cast<double>(same) < 0.7 * static_cast<double>(jump.size())) return 0.0;
  // what always reads the same value has a step of its own at every level: a code that stands for an error
  const auto spread = [](const std::vector<double>& x) { return quantile(x, 0.85) - quantile(x, 0.15); };
  if (spread(value) < 0.5 * spread(jump) || !turn_as_bit_stands(spikes, size)) return 0.0;
  if (!std::isfinite(range_V)) return size < kMostOfSpan * span_V ? size : 0.0;
  const double bits = std::log2(range_V / size);
  return bits > 0.5 && std::abs(bits - std::round(bits)) < 0.12 ? size : 0.0;
}

bool stay_on_one_side(const LoneSpikes& spikes, const std::vector<double>& F_N, double gain_V_per_N, double size_V) {
  constexpr std::size_t kBeside = 3, kAway = 25;
  constexpr double kNearlyAll = 0.8;
  const std::vector<double>& U = spikes.U;
  const auto level = [&](std::size_t begin, std::size_t end) {
    std::vector<double> beside_force;
    for (std::size_t i = begin; i < end; ++i) beside_force.push_back(U[i] - gain_V_per_N * F_N[i]);
    return quantile(std::move(beside_force), 0.5);
  };
  std::size_t alone = 0;
  for (std::size_t k = 0; k < spikes.at.size(); ++k) {
    const std::size_t i = spikes.at[k];
    const bool near_others = (k > 0 && i - spikes.at[k - 1] <= kAway) || (k + 1 < spikes.at.size() && spikes.at[k + 1] - i <= kAway);
    if (near_others || i < kAway || i + kAway >= U.size()) continue;
    alone += std::abs(level(i + kBeside, i + kAway) - level(i - kAway, i - kBeside)) < 0.5 * size_V ? 1 : 0;
  }
  return static_cast<double>(alone) >= kNearlyAll * static_cast<double>(spikes.at.size());
}

}  // namespace forcegate::diagnose
