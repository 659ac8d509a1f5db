#include "hil/rig/rig_witness.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "hil/base/portable_math.h"

namespace forcegate {
namespace {
constexpr std::uint64_t kExamineEvery = 32;
constexpr int kGroup = 10;         // cos() of one sample in ten: the witness is about levels, not edges
constexpr double kMoved_N = 0.1;   // four resolutions of the Nano17
constexpr float kLoaded_N = 0.6f;  // above the offset F0 of any sensor of the kind
constexpr float kCommandMoves_rad_per_s = 0.05f;
constexpr double kFollowForget_s = 1.0;  // what the drive's gain error adds up to is forgotten
constexpr double kJump = 0.02;           // of the converter's range, 0.1 N of a FlexiForce
constexpr float kStood_N = 0.06f;        // ATI from one sample to the next: two steps of the Nano17
constexpr double kCreep_s = 2.0;         // a code that goes this slowly tells of the film, not of the force
constexpr double kFollows = 0.3;         // r^2; the slow FSR at 3 Hz still has 0.5
constexpr std::uint16_t kReferenceBad = kRigReferenceSaturated | kRigReferenceFault;

bool all_sound(const RigBlock& block, std::size_t n) {
  const float *force_N = block.force_ref_N.data(), *theta = block.theta_rad.data();
  const std::uint16_t* status = block.status.data();
  constexpr float kLargest = std::numeric_limits<float>::max();
  unsigned strange = 0;
  for (std::size_t i = 0; i < n; ++i)
    strange |= status[i] | static_cast<unsigned>(!(std::fabs(force_N[i]) <= kLargest)) |
               static_cast<unsigned>(!(std::fabs(theta[i]) <= kLargest));
  return strange == 0;
}
}  // namespace

void RigWitness::begin(const RigInfo& info) {
  *this = RigWitness();
  info_ = info;
  period_s_ = 1.0 / info.rate_Hz;
  reference_lag_ = sensor_lag_ = LagFit(kGroup * period_s_);
  o_.reference_min_N = std::numeric_limits<double>::infinity();
  o_.reference_max_N = -std::numeric_limits<double>::infinity();
}

void RigWitness::close_block() {
  Block& b = block_;
  if (b.n < 10.0) return;
  if (std::fabs(b.bias / b.n) > std::fabs(o_.spring_worst_bias_N)) o_.spring_worst_bias_N = b.bias / b.n;
  const double vff = b.ff / b.n - b.f * b.f / (b.n * b.n), vcc = b.cc / b.n - b.c * b.c / (b.n * b.n);
  const double vfc = b.fc / b.n - b.f * b.c / (b.n * b.n);
  const double last_code = static_cast<double>((1u << info_.adc_bits) - 1u);
  if (!(vff > 0.04) || b.code_low < 1.0 || b.code_high > last_code - 1.0) return;
  ++o_.sensor_blocks;
  o_.sensor_blocks_odd += !(vfc > 0.0 && vfc * vfc > kFollows * vff * vcc);
}

double RigWitness::spring_N(double theta_rad) const {
  const RigGeometry& g = info_.geometry;
  return g.spring_N_per_mm * (g.preload_mm + g.eccentricity_mm * (1.0 - portable::cos(theta_rad)));
}

bool RigWitness::moves(Witness witness, float from, float to) const {
  if (witness == Witness::wheel_rad) return std::fabs(spring_N(to) - spring_N(from)) > kMoved_N;
  if (witness == Witness::force_N) return std::fabs(to - from) > kMoved_N;
  return std::fabs(to - from) > kJump * static_cast<double>((1u << info_.adc_bits) - 1u);
}

// Did the witness of a reading that has not changed for a while move? A film creeps: a code tells only within a short time.
void RigWitness::examine(Still& still, Witness witness, float now, double& longest_s) const {
  if (!still.moved) still.moved = moves(witness, still.witness, now);
  const auto short_run = static_cast<std::uint64_t>(kCreep_s / period_s_) / kExamineEvery * kExamineEvery;
  if (!still.moved && witness == Witness::code && short_run > 0 && still.run % short_run == 0) still.witness = now;
  if (still.moved) longest_s = std::max(longest_s, static_cast<double>(still.run) * period_s_);
}

void RigWitness::push_spring(double t_s, double theta_rad, double force_N, double code) {
  if (t_s - block_.start_s >= kBlockSeconds) {
    close_block();
    block_ = {.start_s = t_s};
  }
  Block& b = block_;
  b.n += 1.0;
  b.f += force_N, b.c += code, b.ff += force_N * force_N, b.fc += force_N * code, b.cc += code * code;
  b.code_low = std::min(b.code_low, code);
  b.code_high = std::max(b.code_high, code);
  if (!(info_.geometry.eccentricity_mm > 0.0) || !std::isfinite(theta_rad)) return;
  const double spring_N = this->spring_N(theta_rad);
  ++o_.spring_samples;
  sx_ += spring_N;
  sy_ += force_N;
  sxx_ += spring_N * spring_N;
  sxy_ += spring_N * force_N;
  syy_ += force_N * force_N;
  b.bias += force_N - spring_N;
  reference_lag_.push(spring_N, force_N);
  sensor_lag_.push(force_N, 10.0 * code / static_cast<double>((1u << info_.adc_bits) - 1u));
}

// Each pass keeps what it counts in locals: members would be written back to memory at every sample.
void RigWitness::push_time(const RigBlock& block, std::size_t n) {
  const double* t_s = block.t_s.data();
  if (o_.samples == 0) {
    o_.first_t_s = block_.start_s = t_s[0];
    previous_t_s_ = t_s[0] - period_s_;
  }
  // The smallest and the largest step say it all unless there is a gap or a step back.
  constexpr std::size_t kLanes = 4;
  const double first_s = t_s[0] - previous_t_s_;
  double low_s[kLanes], high_s[kLanes];
  std::fill_n(low_s, kLanes, first_s);
  std::fill_n(high_s, kLanes, first_s);
  unsigned back = !(first_s > 0.0);
  std::size_t i = 1;
  for (; i + kLanes <= n; i += kLanes)
    for (std::size_t k = 0; k < kLanes; ++k) {
      const double step_s = t_s[i + k] - t_s[i + k - 1];
      back |= !(step_s > 0.0);
      low_s[k] = step_s < low_s[k] ? step_s : low_s[k];
      high_s[k] = step_s > high_s[k] ? step_s : high_s[k];
    }
  for (; i < n; ++i) {
    const double step_s = t_s[i] - t_s[i - 1];
    back |= !(step_s > 0.0);
    low_s[0] = std::min(low_s[0], step_s);
    high_s[0] = std::max(high_s[0], step_s);
  }
  const double shortest_s = *std::min_element(low_s, low_s + kLanes),
               longest_s = *std::max_element(high_s, high_s + kLanes);
  if (back != 0 || longest_s > 1.5 * period_s_) {
    count_strange_times(block, n);
  } else {
    o_.worst_step_s =
        std::max({o_.worst_step_s, std::fabs(shortest_s - period_s_), std::fabs(longest_s - period_s_)});
    o_.worst_gap_s = std::max(o_.worst_gap_s, longest_s - period_s_);
  }
  o_.last_t_s = previous_t_s_ = t_s[n - 1];
  o_.samples += n;
}

void RigWitness::count_strange_times(const RigBlock& block, std::size_t n) {
  double previous_s = previous_t_s_;
  for (std::size_t i = 0; i < n; ++i) {
    const double step_s = block.t_s[i] - previous_s;
    previous_s = block.t_s[i];
    o_.time_not_monotone += !(step_s > 0.0);
    o_.time_gaps += step_s > 1.5 * period_s_;
    o_.worst_step_s = std::max(o_.worst_step_s, std::fabs(step_s - period_s_));
    o_.worst_gap_s = std::max(o_.worst_gap_s, step_s - period_s_);
  }
}

void RigWitness::push_codes(const RigBlock& block, std::size_t n) {
  const std::uint16_t *code = block.adc.data(), *status = block.status.data();
  std::uint16_t low = o_.adc_min, high = o_.adc_max, any = 0, all = 0xFFFF, trouble = 0;
  for (std::size_t i = 0; i < n; ++i) {
    low = std::min(low, code[i]);
    high = std::max(high, code[i]);
    any |= code[i];
    all &= code[i];
    trouble |= status[i];
  }
  o_.adc_min = low;
  o_.adc_max = high;
  adc_or_ |= any;
  adc_and_ &= all;
  if (trouble == 0) return;
  for (std::size_t i = 0; i < n; ++i) {
    o_.lost += (status[i] & kRigSampleLost) != 0;
    o_.reference_saturated += (status[i] & kRigReferenceSaturated) != 0;
    o_.reference_fault += (status[i] & kRigReferenceFault) != 0;
    o_.motor_fault += (status[i] & kRigMotorFault) != 0;
    o_.travel_stop += (status[i] & kRigTravelStop) != 0;
    o_.adc_rail += (status[i] & kRigAdcRail) != 0;
  }
}

template <bool kSound>
void RigWitness::push_force(const RigBlock& block, std::size_t n) {
  const float* force_N = block.force_ref_N.data();
  const std::uint16_t* status = block.status.data();
  double low = o_.reference_min_N, high = o_.reference_max_N, sum = sum_force_, squares = sum_second_;
  double x1 = x1_, x2 = x2_;
  int run = valid_run_;
  std::uint64_t good = 0, seconds = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = force_N[i];
    if (!kSound && (!std::isfinite(x) || status[i] & kReferenceBad)) {
      // A lost row is the link's.
      o_.reference_not_finite += !std::isfinite(x) && !(status[i] & kRigSampleLost);
      run = 0;
      continue;
    }
    low = std::min(low, x);
    high = std::max(high, x);
    sum += x;
    ++good;
    if (run >= 2) {
      const double second = x2 - 2.0 * x1 + x;
      squares += second * second;
      ++seconds;
    }
    x2 = x1;
    x1 = x;
    ++run;
  }
  o_.reference_min_N = low;
  o_.reference_max_N = high;
  sum_force_ = sum;
  sum_second_ = squares;
  force_n_ += good;
  second_n_ += seconds;
  x1_ = static_cast<float>(x1);
  x2_ = static_cast<float>(x2);
  valid_run_ = std::min(run, 1000);
}

// Readings that do not change while the spring moves, codes at the rail under load, jumps of the code.
template <bool kSound>
void RigWitness::push_changes(const RigBlock& block, std::size_t n) {
  const float *force_N = block.force_ref_N.data(), *theta = block.theta_rad.data();
  const std::uint16_t *code = block.adc.data(), *status = block.status.data();
  const auto last_code = static_cast<std::uint16_t>((1u << info_.adc_bits) - 1u);
  const int jump = std::max(4, static_cast<int>(kJump * last_code));
  std::uint64_t jumps = 0, dead_run = dead_run_;
  float previous_N = previous_force_N_;
  std::uint16_t previous_code = previous_code_;
  Still reference = reference_still_, sensor = sensor_still_;
  // A reading in steps changes by chance: what follows from it is chosen without branches, only the rare cases jump.
  const bool wheel = info_.geometry.eccentricity_mm > 0.0;
  const Witness of_reference = wheel ? Witness::wheel_rad : Witness::code, of_sensor = wheel ? Witness::wheel_rad : Witness::force_N;
  const auto count = [this](Still& still, bool same, Witness witness, float now, double& longest_s, double& stale_s) {
    if (still.moved && !same) {
      stale_s += static_cast<double>(still.run) * period_s_;
      still.moved = false;
    }
    still.run = same ? still.run + 1 : 0;
    still.witness = same ? still.witness : now;
    if (still.run != 0 && still.run % kExamineEvery == 0) {
      Still seen = still;  // a copy: what a call may change cannot stay in registers
      examine(seen, witness, now, longest_s);
      still = seen;
    }
  };
  for (std::size_t i = 0; i < n; ++i) {
    const float now_N = force_N[i];
    const std::uint16_t now_code = code[i];
    if (!kSound && (!std::isfinite(now_N) || status[i] & kReferenceBad)) {
      previous_N = std::numeric_limits<float>::quiet_NaN();
      continue;
    }
    count(reference, now_N == previous_N, of_reference, wheel ? theta[i] : static_cast<float>(now_code), o_.reference_frozen_s, o_.reference_stale_s);
    // At a rail one code is what a sound sensor gives too: below F0 at the first, above the range at the last.
    const bool rail = now_code == 0 || now_code == last_code;
    const double stale_before_s = o_.sensor_stale_s;
    count(sensor, now_code == previous_code && !rail, of_sensor, wheel ? theta[i] : now_N, o_.sensor_dead_s, o_.sensor_stale_s);
    if (previous_code > clip_code_ && previous_code != last_code) clip_code_ = previous_code, clip_s_ = 0.0;
    if (previous_code == clip_code_) clip_s_ += o_.sensor_stale_s - stale_before_s;
    if (now_code == 0 && now_N > kLoaded_N) {
      o_.sensor_dead_s = std::max(o_.sensor_dead_s, static_cast<double>(++dead_run) * period_s_);
    } else {
      dead_run = 0;
    }
    // NaN before the first valid row: no step.
    jumps += std::abs(now_code - previous_code) > jump && std::fabs(now_N - previous_N) < kStood_N;
    previous_N = now_N;
    previous_code = now_code;
  }
  o_.sensor_jumps += jumps;
  dead_run_ = dead_run;
  previous_force_N_ = previous_N;
  previous_code_ = previous_code;
  reference_still_ = reference;
  sensor_still_ = sensor;
}

template <bool kSound>
void RigWitness::push_groups(const RigBlock& block, std::size_t n) {
  const float *force_N = block.force_ref_N.data(), *theta = block.theta_rad.data();
  const std::uint16_t *code = block.adc.data(), *status = block.status.data();
  int filled = group_n_;
  double sum_theta = group_theta_, sum_force = group_force_, sum_code = group_code_;
  for (std::size_t i = 0; i < n; ++i) {
    if (!kSound && (!std::isfinite(force_N[i]) || status[i] & kReferenceBad)) continue;
    sum_theta += theta[i];
    sum_force += force_N[i];
    sum_code += code[i];
    if (++filled < kGroup) continue;
    push_spring(block.t_s[i], sum_theta / kGroup, sum_force / kGroup, sum_code / kGroup);
    filled = 0;
    sum_theta = sum_force = sum_code = 0.0;
  }
  group_n_ = filled;
  group_theta_ = sum_theta, group_force_ = sum_force, group_code_ = sum_code;
}

// e = integral of (command - theta'), v = theta'. Both sides pass the same leak, so e = tau v of a sound drive stays true;
// at a stop the sums begin anew.
template <bool kSound>
void RigWitness::push_wheel(const RigBlock& block, std::size_t n, const float* commanded) {
  const float *force_N = block.force_ref_N.data(), *theta = block.theta_rad.data();
  const std::uint16_t* status = block.status.data();
  const double per_period = 1.0 / period_s_, keep = 1.0 - period_s_ / kFollowForget_s;
  double e = follow_e_, v_high = follow_v_, previous_v = follow_previous_v_, last = follow_last_;
  double count = 0.0, ee = 0.0, ev = 0.0, vv = 0.0;
  float previous = previous_theta_;
  std::uint64_t still = theta_run_, longest = 0;
  command_rows_ += static_cast<double>(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double step = static_cast<double>(commanded[i]) - static_cast<double>(previous_command_);
    command_steps_ += step * step;
    previous_command_ = commanded[i];
    if (!kSound && (!std::isfinite(force_N[i]) || status[i] & kReferenceBad)) {
      last = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    if (!kSound && !std::isfinite(theta[i])) continue;
    const bool stop = !kSound && status[i] & kRigTravelStop;
    const double moved = static_cast<double>(theta[i]) - last, v = moved * per_period;
    if (stop || (!kSound && status[i] & kRigSampleLost) || !std::isfinite(v + previous_v)) {
      e = v_high = 0.0;
    } else {
      e = keep * e + (commanded[i] * period_s_ - moved);
      v_high = keep * v_high + (v - previous_v);
      count += 1.0;
      ee += e * e;
      ev += e * v_high;
      vv += v_high * v_high;
    }
    previous_v = v;
    last = stop ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(theta[i]);
    const bool should_move = std::fabs(commanded[i]) > kCommandMoves_rad_per_s && !stop;
    still = theta[i] == previous && should_move ? still + 1 : 0;
    longest = std::max(longest, still);
    previous = theta[i];
  }
  follow_e_ = e, follow_v_ = v_high, follow_previous_v_ = previous_v, follow_last_ = static_cast<float>(last);
  fn_ += count, fee_ += ee, fev_ += ev, fvv_ += vv;
  previous_theta_ = previous;
  theta_run_ = still;
  o_.theta_still_while_commanded_s =
      std::max(o_.theta_still_while_commanded_s, static_cast<double>(longest) * period_s_);
}

template <bool kSound>
void RigWitness::push_rows(const RigBlock& block, std::size_t n, const float* commanded) {
  push_force<kSound>(block, n);
  push_changes<kSound>(block, n);
  push_groups<kSound>(block, n);
  if (info_.geometry.eccentricity_mm > 0.0 && commanded != nullptr) push_wheel<kSound>(block, n, commanded);
}

void RigWitness::push(const RigBlock& block, std::size_t n, const float* commanded) {
  if (n == 0) return;
  push_time(block, n);
  push_codes(block, n);
  if (all_sound(block, n))
    push_rows<true>(block, n, commanded);
  else
    push_rows<false>(block, n, commanded);
}

RigObservation RigWitness::finish() const {
  RigWitness end = *this;
  end.close_block();
  if (end.reference_still_.moved)
    end.o_.reference_stale_s += static_cast<double>(end.reference_still_.run) * period_s_;
  if (end.clip_code_ == end.o_.adc_max) end.o_.sensor_clipped_s = end.clip_s_;
  if (end.sensor_still_.moved)
    end.o_.sensor_stale_s += static_cast<double>(end.sensor_still_.run) * period_s_;
  RigObservation o = end.o_;
  if (second_n_ > 0) o.reference_noise_N = std::sqrt(sum_second_ / (6.0 * static_cast<double>(second_n_)));
  if (force_n_ > 0) o.reference_mean_N = sum_force_ / static_cast<double>(force_n_);
  // A healthy converter toggles every bit below the highest one that its span needs.
  const unsigned span = o.samples > 0 && o.adc_max >= o.adc_min ? o.adc_max - o.adc_min : 0u;
  const unsigned expected = span > 3 ? (std::bit_floor(span) - 1u) : 0u;
  o.adc_bits_stuck = static_cast<std::uint16_t>(~(adc_or_ ^ adc_and_) & expected);
  const double n = static_cast<double>(o.spring_samples);
  if (command_rows_ > 0.0)
    o.command_step_rad = kCommandPeriod_s * std::sqrt(command_steps_ / (command_rows_ * period_s_ / kCommandPeriod_s));
  if (o.spring_samples < kLeastSpringSamples) {
    o.spring_bias_N = o.spring_rms_N = o.spring_worst_bias_N = std::numeric_limits<double>::quiet_NaN();
    return o;
  }
  const double vx = sxx_ / n - (sx_ / n) * (sx_ / n);
  const double cxy = sxy_ / n - (sx_ / n) * (sy_ / n);
  const double vy = syy_ / n - (sy_ / n) * (sy_ / n);
  o.spring_bias_N = (sy_ - sx_) / n;
  o.spring_rms_N = std::sqrt(std::max(0.0, vy - 2.0 * cxy + vx));
  if (vx > 0.01) o.spring_slope = cxy / vx;
  double unused = 0.0;
  reference_lag_.finish(o.reference_lag_s, unused);
  sensor_lag_.finish(o.sensor_lag_s, unused);
  if (fn_ > 100.0)
    o.following_rad = std::sqrt(std::max(0.0, fee_ - (fvv_ > 0.0 ? fev_ * fev_ / fvv_ : 0.0)) / fn_);
  return o;
}

}  // namespace forcegate
