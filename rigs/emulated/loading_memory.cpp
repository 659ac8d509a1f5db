#include "rigs/emulated/loading_memory.h"

#include <algorithm>
#include <cmath>

#include "hil/base/portable_math.h"

namespace forcegate::emulated {
namespace {

constexpr double kConditioning_s = 15.0;
constexpr int kConditioningTraverses = 3;
constexpr double kForget_s = 300.0;
constexpr double kFullSwing = 0.75;  // share of the envelope that a traverse must cross
constexpr double kRhythmFast_s = 4.0, kRhythmSlow_s = 25.0, kRhythmDeadBand = 0.15;
constexpr double kHabit_s = 60.0;

}  // namespace

void LoadingMemory::begin(const LoadingParameters& p, double step_s, double force_N, double lost,
                          double rest_before_s) {
  *this = LoadingMemory{};
  p_ = p;
  step_s_ = step_s;
  lo_ = hi_ = extreme_ = swing_extreme_ = force_N;
  for (int i = 0; i < 3; ++i) {
    group_[i] = lost * portable::exp(-rest_before_s / p.recovery_s[i]);
    lost_ += p.share[i] * group_[i];
  }
  residue_ = p.sign * p.residue * lost_;
}

void LoadingMemory::turn(double force_N) {
  const double half_cycle_s = seconds(extreme_at_ - last_turn_at_);
  const bool quiet = activity_ < 0.5;
  if (rising_) {
    if (quiet) {  // a new run of cycles: what was touched before it does not belong to its envelope
      lo_ = force_N;
      hi_ = extreme_;
    } else {
      hi_ += std::min(1.0, 2.0 * half_cycle_s / p_.envelope_s) * (extreme_ - hi_);
    }
  } else if (!quiet) {
    lo_ += std::min(1.0, 2.0 * half_cycle_s / p_.envelope_s) * (extreme_ - lo_);
  }
  if (half_cycle_s > 0.0) {
    const double rhythm = portable::log(half_cycle_s);
    const double before = half_cycle_s_;
    if (before <= 0.0 || before > p_.slow_half_cycle_s || half_cycle_s > p_.slow_half_cycle_s) {
      rhythm_fast_ = rhythm_slow_ = rhythm;
    } else {
      rhythm_fast_ += std::min(1.0, half_cycle_s / kRhythmFast_s) * (rhythm - rhythm_fast_);
      rhythm_slow_ += std::min(1.0, half_cycle_s / kRhythmSlow_s) * (rhythm - rhythm_slow_);
    }
    half_cycle_s_ = half_cycle_s;
  }
  full_swing_turn(extreme_, extreme_at_);
  turned_ = true;
  last_turn_at_ = extreme_at_;
  rising_ = !rising_;
  extreme_ = force_N;
  extreme_at_ = index_;
}

// Zigzag over the turning points themselves: only reversals of most of the envelope count.
void LoadingMemory::full_swing_turn(double value_N, std::int64_t at) {
  const bool further = swing_rising_ ? value_N >= swing_extreme_ : value_N <= swing_extreme_;
  if (further) {
    swing_extreme_ = value_N;
    swing_extreme_at_ = at;
    return;
  }
  if (std::abs(value_N - swing_extreme_) < kFullSwing * (hi_ - lo_)) return;
  const double traverse_s = seconds(swing_extreme_at_ - swing_turn_at_);
  if (traverse_s > 0.0 && !conditioned_) {
    if (hi_ - lo_ > 1.1 * counted_swing_) {  // until now only a part of the swing had been crossed
      counted_swing_ = hi_ - lo_;
      traverses_ = 0;
      traverse_s_ = 0.0;
    }
    ++traverses_;
    // The first traverse may begin with a pause; a running mean over the following ones.
    traverse_s_ = traverses_ <= 2 ? traverse_s : traverse_s_ + (traverse_s - traverse_s_) / (traverses_ - 1);
  }
  swing_turn_at_ = swing_extreme_at_;
  swing_rising_ = !swing_rising_;
  swing_extreme_ = value_N;
  swing_extreme_at_ = at;
}

void LoadingMemory::tick(double dt_s, double force_N) {
  const double swing_N = hi_ - lo_;
  prominence_ = std::max(0.05, 0.1 * swing_N);

  if (turned_) {
    const double pause_s = std::max(half_cycle_s_, seconds(index_ - last_turn_at_));
    const double slow = pause_s / p_.slow_half_cycle_s;
    const double slow2 = slow * slow;
    activity_ = 1.0 / (1.0 + slow2 * slow2 * slow2 * slow2);
  }
  const double release = swing_N > 0.0 ? std::clamp((hi_ - force_N) / swing_N, 0.0, 1.0) : 1.0;

  if (!conditioned_) {
    active_s_ += activity_ * dt_s;
    amplitude_ = 0.5 * swing_N;
    frequency_ = traverse_s_ > 0.0 ? 0.5 / traverse_s_ : 0.0;
    conditioned_ = active_s_ >= kConditioning_s && traverses_ >= kConditioningTraverses;
  }
  quiet_s_ = activity_ < 0.2 ? quiet_s_ + release * dt_s : 0.0;
  if (quiet_s_ > kForget_s) {
    conditioned_ = false;
    active_s_ = traverse_s_ = 0.0;
    traverses_ = 0;
    counted_swing_ = 0.0;
    swing_extreme_ = force_N;
    swing_extreme_at_ = swing_turn_at_ = index_;
  }

  const double rate_per_s = p_.b_scale * (p_.rate_offset_per_s + p_.rate_slope_per_s_Hz * frequency_);
  const double q = p_.q_scale / (1.0 + p_.ratio_curvature_per_N2 * amplitude_ * amplitude_);
  const double floor = p_.fixed_loss < 0.0 ? 1.0 / (1.0 + q) : p_.fixed_loss;
  lost_ = 0.0;
  for (int i = 0; i < 3; ++i) {
    group_[i] += dt_s * (activity_ * rate_per_s * (floor - group_[i]) -
                         (1.0 - activity_) * release * group_[i] / p_.recovery_s[i]);
    lost_ += p_.share[i] * group_[i];
  }

  const double gap = activity_ - expression_;
  expression_ += dt_s * gap * (gap > 0.0 ? 1.0 / p_.show_s : release * release / p_.hide_s);

  // A rhythm that varies all the time is no change of rhythm: the film gets used to it.
  const double variation = std::abs(rhythm_fast_ - rhythm_slow_);
  habit_ += dt_s / kHabit_s * (variation - habit_);
  const double change = variation - kRhythmDeadBand - 1.5 * habit_;
  const double kick = std::clamp(1.2 * change, 0.0, p_.bump);
  disturbance_ += dt_s * (kick > disturbance_ ? (kick - disturbance_) : -disturbance_ / p_.bump_fade_s);

  loss_ = p_.sign * lost_ * expression_ * (1.0 - disturbance_);
  residue_ = p_.sign * p_.residue * lost_ * (1.0 - expression_);
}

}  // namespace forcegate::emulated
