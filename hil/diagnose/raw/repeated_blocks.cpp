#include "hil/diagnose/raw/repeated_blocks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kWindow = 10, kFewestChanges = 4;

std::uint64_t bits_of(double value) { return std::bit_cast<std::uint64_t>(value) * 0x9E3779B97F4A7C15ULL; }

// Where a window of samples was last seen.
class LastSeen {
 public:
  explicit LastSeen(std::span<const double> U) : U_(U), mask_(std::bit_ceil(2 * U.size()) - 1), at_(mask_ + 1, 0) {
    for (std::size_t i = 0; i + 1 < kWindow; ++i) oldest_ *= kBase;
    for (std::size_t i = 0; i < kWindow; ++i) hash_ = hash_ * kBase + bits_of(U[i]);
  }

  // The start of an equal window that came before the one at `i`, else `i`; windows are asked one after the other from 0 on.
  std::size_t before(std::size_t i) {
    if (i > 0) hash_ = (hash_ - bits_of(U_[i - 1]) * oldest_) * kBase + bits_of(U_[i + kWindow - 1]);
    std::uint32_t& slot = at_[(hash_ ^ (hash_ >> 32)) & mask_];
    const std::size_t last = slot;
    slot = static_cast<std::uint32_t>(i + 1);
    return last > 0 && std::equal(U_.begin() + static_cast<std::ptrdiff_t>(i), U_.begin() + static_cast<std::ptrdiff_t>(i + kWindow),
                                  U_.begin() + static_cast<std::ptrdiff_t>(last - 1))
               ? last - 1
               : i;
  }

 private:
  static constexpr std::uint64_t kBase = 0xD6E8FEB86659FD93ULL;
  std::span<const double> U_;
  std::uint64_t hash_ = 0, oldest_ = 1;
  std::size_t mask_;
  std::vector<std::uint32_t> at_;  // one more than the place; 0: none
};

std::size_t changes_in(std::span<const double> window) {
  std::size_t out = 0;
  for (std::size_t i = 1; i < window.size(); ++i) out += window[i] != window[i - 1] ? 1 : 0;
  return out;
}

// Of two samples at one level: sum of the squared shares of the steps that the noise goes over, step / (2 sqrt(pi) sigma) from a step on.
double chance_at_one_level(double lsb_V, double noise_V) {
  const double of_level_V = std::sqrt(noise_V * noise_V - lsb_V * lsb_V / 12.0);  // the steps' own share is no noise
  return lsb_V / (2.0 * std::sqrt(std::numbers::pi) * of_level_V);
}

// How likely two samples that far apart are equal where they are near each other, at the levels of the block; some thousands tell. Of an output that
// creeps hardly any two are at one level, and those of the block are.
double chance_of_equal(std::span<const double> U, const RepeatedBlock& block, double reach_V) {
  constexpr double kEnough = 4000.0;
  const auto [low, high] = std::ranges::minmax(U.subspan(block.begin, block.end - block.begin));
  double all = 0.0, equal = 0.0;
  for (std::size_t i = block.before; i < U.size() && all < kEnough; ++i) {
    const bool counts = (i < block.begin || i >= block.end) && U[i] >= low - reach_V && U[i] <= high + reach_V;
    if (!counts || !(std::abs(U[i] - U[i - block.before]) <= reach_V)) continue;
    all += 1.0;
    equal += U[i] == U[i - block.before] ? 1.0 : 0.0;
  }
  return (1.0 + equal) / (2.0 + all);
}

bool repeats_too(std::span<const double> beside, const RepeatedBlock& block) {
  constexpr double kMost = 0.9;
  double equal = 0.0;
  for (std::size_t i = block.begin; i < block.end; ++i) equal += beside[i] == beside[i - block.before] ? 1.0 : 0.0;
  return equal > kMost * static_cast<double>(block.end - block.begin);
}

}  // namespace

std::vector<RepeatedBlock> find_repeated_blocks(std::span<const double> U, std::span<const double> beside, double lsb_V, double noise_V) {
  constexpr double kByChance = 1e-6, kByChanceBesidePlain = 0.05, kSigmas = 4.0;
  constexpr double kLongest = 0.1;  // of the record; a longer one is its period
  constexpr std::ptrdiff_t kFewestPlain = 3;
  const std::size_t n = U.size();
  if (n < 2 * kWindow || !(noise_V > lsb_V)) return {};
  const double reach_V = kSigmas * noise_V, at_one_level = chance_at_one_level(lsb_V, noise_V);
  struct Candidate {
    RepeatedBlock block;
    double by_chance;  // ln of how many such blocks are expected
  };
  std::vector<Candidate> found;
  LastSeen seen(U);
  std::size_t done = 0;
  for (std::size_t i = 0; i + kWindow <= n; ++i) {
    const std::size_t from = seen.before(i);
    if (from == i || i < done || changes_in(U.subspan(i, kWindow)) < kFewestChanges) continue;
    RepeatedBlock block{i, i + kWindow, i - from};
    while (block.begin > std::max(done, block.before) && U[block.begin - 1] == U[block.begin - 1 - block.before]) --block.begin;
    while (block.end < n && U[block.end] == U[block.end - block.before]) ++block.end;
    done = block.end;
    const double length = static_cast<double>(block.end - block.begin);
    if (length > kLongest * static_cast<double>(n) || repeats_too(beside, block)) continue;
    const double pairs = static_cast<double>(n) * static_cast<double>(block.before);
    found.push_back({block, std::log(pairs) + length * std::log(std::max(at_one_level, chance_of_equal(U, block, reach_V)))});
  }
  const auto is_plain = [](const Candidate& c) { return c.by_chance < std::log(kByChance); };
  const double most = std::ranges::count_if(found, is_plain) < kFewestPlain ? kByChance : kByChanceBesidePlain;
  std::vector<RepeatedBlock> out;
  for (const Candidate& c : found)
    if (c.by_chance < std::log(most)) out.push_back(c.block);
  return out;
}

}  // namespace forcegate::diagnose
