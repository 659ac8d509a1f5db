#include "hil/diagnose/raw/silent_runs.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/raw/range_ends.h"

namespace forcegate::diagnose {

namespace {

// Pairs of neighbours by the level of their first sample, and how many of them are equal.
class PairsByLevel {
 public:
  PairsByLevel(std::span<const double> U, double low, double high) : low_(low), width_((high - low) / kBins), all_(kBins, 0.0), equal_(kBins, 0.0) {
    for (std::size_t i = 0; i + 1 < U.size(); ++i) {
      if (!std::isfinite(U[i]) || !std::isfinite(U[i + 1])) continue;
      all_[bin(U[i])] += 1.0;
      equal_[bin(U[i])] += U[i + 1] == U[i] ? 1.0 : 0.0;
    }
  }

  struct Pairs {
    double all = 0.0, equal = 0.0;
  };
  Pairs near(double U, double reach) const {
    Pairs out;
    for (std::size_t k = bin(U - reach); k <= bin(U + reach); ++k) out.all += all_[k], out.equal += equal_[k];
    return out;
  }

 private:
  static constexpr std::size_t kBins = 400;
  std::size_t bin(double U) const { return static_cast<std::size_t>(std::clamp((U - low_) / width_, 0.0, kBins - 1.0)); }

  double low_, width_;
  std::vector<double> all_, equal_;
};

// A code that is wider than the others is met again.
void leave_out_wide_codes(std::span<const double> U, std::size_t short_below, std::vector<SilentRun>& runs) {
  const std::vector<SilentRun> all = runs;
  std::erase_if(runs, [&](const SilentRun& run) {
    const auto at_this_code = std::ranges::count_if(all, [&](const SilentRun& other) { return U[other.begin] == U[run.begin]; });
    return run.end - run.begin < short_below && at_this_code > 1;
  });
}

}  // namespace

std::vector<SilentRun> find_silent_runs(std::span<const double> U, double lsb_V, double noise_V) {
  constexpr std::size_t kShortest = 5, kAlone = 8;  // samples; of a run that needs no other
  constexpr double kEnds = 2.5, kReach = 0.01, kFarthest = 0.1, kSigmas = 4.0, kFewestPairs = 100.0, kTimesAsMany = 3.0, kByChance = 1e-6, kSomeByChance = 1e-3;
  std::vector<SilentRun> out;
  const auto [low, high] = spread_of_present(U);
  if (!(lsb_V > 0.0) || !(noise_V > lsb_V) || !(high > low)) return out;
  const PairsByLevel pairs(U, low, high);
  const double reach = std::max(kReach * (high - low), kSigmas * noise_V), n = static_cast<double>(U.size());
  for (std::size_t begin = 0, end = 0; begin < U.size(); begin = end) {
    for (end = begin + 1; end < U.size() && U[end] == U[begin];) ++end;
    if (end - begin < kShortest || begin == 0 || end == U.size() || U[begin] < low + kEnds * lsb_V || U[begin] > high - kEnds * lsb_V) continue;
    const double own = static_cast<double>(end - begin - 1);
    const double fewest = own + std::max(kFewestPairs, kTimesAsMany * own);
    PairsByLevel::Pairs near = pairs.near(U[begin], reach);
    for (double farther = 2.0 * reach; near.all < fewest && farther < kFarthest * (high - low); farther *= 2.0) near = pairs.near(U[begin], farther);
    const auto [all, equal] = near;
    if (all < fewest) continue;
    const double p = (1.0 + equal - own) / (2.0 + all - own);
    const bool alone = end - begin >= kAlone;
    if (std::log(n) + own * std::log(p) < std::log(alone ? kByChance : kSomeByChance)) out.push_back({begin, end});
  }
  leave_out_wide_codes(U, kAlone, out);
  return out;
}

}  // namespace forcegate::diagnose
