#include "hil/diagnose/raw/suspect_runs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "hil/diagnose/raw/range_ends.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kShortest = 4, kFlatTop = 8, kCertain = 16;  // samples

// Of the samples that are there; a lost one of the reference does not hide what the output does meanwhile.
double mean_of_present(std::span<const double> x) {
  double sum = 0.0, n = 0.0;
  for (const double v : x)
    if (std::isfinite(v)) {
      sum += v;
      n += 1.0;
    }
  return n > 0.0 ? sum / n : kMissing;
}

// Halves against each other: the scatter of a noisy reference is no movement.
double movement_of(std::span<const double> x) {
  const std::size_t half = x.size() / 2;
  return 2.0 * std::abs(mean_of_present(x.last(half)) - mean_of_present(x.first(half)));
}

// Between its eighths, whose means scatter less than its samples; 0 for what is too short to have some.
double swing_of(std::span<const double> x) {
  constexpr std::size_t kParts = 8, kFewest = 4;
  if (x.size() < kParts * kFewest) return 0.0;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t k = 0; k < kParts; ++k) {
    const double mean = mean_of_present(x.subspan(k * x.size() / kParts, x.size() / kParts));
    low = std::min(low, mean);
    high = std::max(high, mean);
  }
  return low <= high ? high - low : 0.0;
}

class Runs {
 public:
  Runs(std::span<const double> F, std::span<const double> U, const RunScales& s)
      : F_(F), U_(U), s_(s), ends_(ends_of_range(U, s.low_V, s.high_V, s.lsb_U_V, s.noise_U_V)), steps_(F, U, s.gain_V_per_N, s.quiet_V),
        move_V_(std::max({0.015 * s.U_range_V, 4.0 * s.lsb_U_V, 6.0 * s.gain_V_per_N * s.noise_F_N})) {}

  std::optional<SuspectRun> judge(std::size_t begin, std::size_t end) const {
    const std::size_t length = end - begin;
    const double U = U_[begin], gain = s_.gain_V_per_N;
    if (length < kShortest || !std::isfinite(U)) return {};
    const auto [low, high] = spread_of_present(F_.subspan(begin, length));
    const bool at_top = U >= s_.top_V - 1e-12, at_bottom = std::abs(U - s_.low_V) < 1e-9 + s_.lsb_U_V;
    if (!falls_and_rises(begin, end, low, high, at_bottom)) {
      const double moved = std::min(movement_of(F_.subspan(begin, length)), high - low), there_and_back = swing_of(F_.subspan(begin, length));
      const bool cycles = there_and_back > kCycles * moved && gain * there_and_back > kCycles * move_V_, silent = lacks_noise(begin, end);
      const bool late = !cycles && !silent && !rejoins(begin, end) && is_late(begin, end, moved);
      // noise breaks the flat top of an output that stops there into short runs at its last codes
      const bool of_top = U >= s_.top_V - 1.5 * s_.lsb_U_V && !(at_top && length >= kFlatTop);
      const bool allowed = (ends_.holds(U) && !steps_.falls_at(begin)) || (late && !at_top && !at_bottom) || of_top;
      if (allowed || !(cycles || gain * std::max(moved, silent ? there_and_back : 0.0) > move_V_)) return {};
    }
    return SuspectRun{begin, end, at_top && length >= kFlatTop ? BadSample::rail : at_bottom ? BadSample::zero : BadSample::held, 0.5 * gain * (high - low)};
  }

 private:
  static constexpr double kCycles = 3.0;

  double release_V(std::size_t begin, std::size_t end) const { return end < U_.size() ? std::abs(U_[end] - U_[begin]) : 0.0; }

  // It goes on as the force went.
  bool is_late(std::size_t begin, std::size_t end, double moved_N) const {
    const double release = release_V(begin, end), next = end + 1 < U_.size() ? std::abs(U_[end + 1] - U_[end]) : 0.0;
    return release < 0.5 * s_.gain_V_per_N * moved_N || release < 2.5 * next;
  }

  // The force turned meanwhile, and the output is back with it in one jump: a late one would have turned later, and would be on its way.
  bool rejoins(std::size_t begin, std::size_t end) const {
    constexpr double kOfRange = 0.1, kLeastGain = 0.15, kJump = 5.0;  // a film that has lost its swing has a sixth of its gain
    if (end - begin < kCertain || end + 1 >= U_.size()) return false;
    const auto [low, high] = spread_of_present(F_.subspan(begin, end - begin));
    const double from = F_[begin], to = F_[end], net = to - from, gain = s_.gain_V_per_N, jump = U_[end] - U_[begin];
    const double there_N = high - std::max(from, to), back_N = std::min(from, to) - low;
    const bool turned = gain * std::max(there_N, back_N) > kOfRange * s_.U_range_V;
    return turned && (s_.rises ? jump : -jump) * net > 0.0 && std::abs(jump) > kLeastGain * gain * std::abs(net) && std::abs(jump) > kJump * std::max(std::abs(U_[end + 1] - U_[end]), 2.0 * s_.lsb_U_V);
  }

  // A late output does not stand still at one code that its noise goes over, and then let go with a jump.
  bool lacks_noise(std::size_t begin, std::size_t end) const {
    constexpr double kJump = 4.0;
    return s_.lsb_U_V > 0.0 && s_.noise_U_V > s_.lsb_U_V && end - begin >= kCertain && release_V(begin, end) > kJump * s_.noise_U_V;
  }

  // Down and up again though the force stays where it is, before and after too: an output at the end of its range glides there.
  bool falls_and_rises(std::size_t begin, std::size_t end, double low_N, double high_N, bool at_bottom) const {
    if (!at_bottom || begin == 0 || end >= U_.size() || !(steps_.calm_before(begin) || steps_.calm_behind(end, U_[begin]))) return false;
    for (std::size_t k = begin >= 2 ? begin - 2 : 0; k < std::min(U_.size(), end + 2); ++k) {
      low_N = std::min(low_N, F_[k]);
      high_N = std::max(high_N, F_[k]);
    }
    return steps_.exceeds(std::min(U_[begin - 1], U_[end]) - U_[begin], high_N - low_N);
  }

  std::span<const double> F_, U_;
  const RunScales& s_;
  RangeEnds ends_;
  StepsOfOutput steps_;
  double move_V_;
};

}  // namespace

std::vector<SuspectRun> find_suspect_runs(std::span<const double> F, std::span<const double> U, const RunScales& scales) {
  std::vector<SuspectRun> out;
  const Runs runs(F, U, scales);
  for (std::size_t begin = 0, end = 0; begin < U.size(); begin = end) {
    for (end = begin + 1; end < U.size() && U[end] == U[begin];) ++end;
    if (const std::optional<SuspectRun> run = runs.judge(begin, end)) out.push_back(*run);
  }
  return out;
}

}  // namespace forcegate::diagnose
