#include "hil/rig/rig_witness.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "hil/base/portable_math.h"

namespace forcegate {
namespace {
constexpr std::uint64_t kExamineEvery = 32;
constexpr int kSpringEvery = 10;   // cos() of one sample in ten: the witness is about levels, not edges
constexpr double kMoved_N = 0.1;   // four resolutions of the Nano17
constexpr float kLoaded_N = 0.6f;  // above the offset F0 of any sensor of the kind
constexpr float kCommandMoves_rad_per_s = 0.05f;
constexpr std::uint16_t kReferenceBad = kRigReferenceSaturated | kRigReferenceFault;
}  // namespace

void RigWitness::begin(const RigInfo& info) {
  *this = RigWitness();
  info_ = info;
  period_s_ = 1.0 / info.rate_Hz;
  o_.reference_min_N = std::numeric_limits<double>::infinity();
  o_.reference_max_N = -std::numeric_limits<double>::infinity();
}

void RigWitness::close_spring_block() {
  if (block_n_ < 10) return;
  const double mean_N = block_sum_ / static_cast<double>(block_n_);
  if (std::fabs(mean_N) > std::fabs(o_.spring_worst_bias_N)) o_.spring_worst_bias_N = mean_N;
}

double RigWitness::spring_N(double theta_rad) const {
  const RigGeometry& g = info_.geometry;
  return g.spring_N_per_mm * (g.preload_mm + g.eccentricity_mm * (1.0 - portable::cos(theta_rad)));
}

// Looks at a reading that has not changed for a while: did the spring move meanwhile?
void RigWitness::examine(Still& still, float theta_rad, double& longest_s) const {
  if (!still.moved) still.moved = std::fabs(spring_N(theta_rad) - spring_N(still.theta_rad)) > kMoved_N;
  if (still.moved) longest_s = std::max(longest_s, static_cast<double>(still.run) * period_s_);
}

void RigWitness::push_spring(double t_s, double theta_rad, double force_N) {
  const double spring_N = this->spring_N(theta_rad);
  ++o_.spring_samples;
  sx_ += spring_N;
  sy_ += force_N;
  sxx_ += spring_N * spring_N;
  sxy_ += spring_N * force_N;
  syy_ += force_N * force_N;
  if (t_s - block_start_s_ >= kBlockSeconds) {
    close_spring_block();
    block_start_s_ = t_s;
    block_sum_ = 0.0;
    block_n_ = 0;
  }
  block_sum_ += force_N - spring_N;
  ++block_n_;
}

// Each pass keeps what it counts in locals: members would be written back to memory at every sample.
void RigWitness::push_time(const RigBlock& block, std::size_t n) {
  const double* t_s = block.t_s.data();
  if (o_.samples == 0) {
    o_.first_t_s = block_start_s_ = t_s[0];
    previous_t_s_ = t_s[0] - period_s_;
  }
  double previous_s = previous_t_s_, worst_s = o_.worst_step_s;
  const double period_s = period_s_, gap_s = 1.5 * period_s_;
  std::uint64_t back = 0, gaps = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double step_s = t_s[i] - previous_s;
    previous_s = t_s[i];
    back += !(step_s > 0.0);
    gaps += step_s > gap_s;
    worst_s = std::max(worst_s, std::fabs(step_s - period_s));
  }
  o_.time_not_monotone += back;
  o_.time_gaps += gaps;
  o_.worst_step_s = worst_s;
  o_.last_t_s = previous_t_s_ = previous_s;
  o_.samples += n;
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

void RigWitness::push_force(const RigBlock& block, std::size_t n) {
  const float* force_N = block.force_ref_N.data();
  const std::uint16_t* status = block.status.data();
  double low = o_.reference_min_N, high = o_.reference_max_N, sum = sum_force_, squares = sum_second_;
  double x1 = x1_, x2 = x2_;
  int run = valid_run_;
  std::uint64_t good = 0, seconds = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = force_N[i];
    if (!std::isfinite(x) || status[i] & kReferenceBad) {
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

void RigWitness::push_motion(const RigBlock& block, std::size_t n, const float* commanded) {
  const bool wheel = info_.geometry.eccentricity_mm > 0.0;
  const float *force_N = block.force_ref_N.data(), *theta = block.theta_rad.data();
  const std::uint16_t *code = block.adc.data(), *status = block.status.data();
  const auto last_code = static_cast<std::uint16_t>((1u << info_.adc_bits) - 1u);
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(force_N[i]) || status[i] & kReferenceBad) {
      previous_force_N_ = std::numeric_limits<float>::quiet_NaN();
      continue;
    }
    const auto count = [&](Still& still, bool same, double& longest_s) {
      if (!same)
        still = {0, theta[i], false};
      else if (++still.run % kExamineEvery == 0)
        examine(still, theta[i], longest_s);
    };
    count(reference_still_, force_N[i] == previous_force_N_, o_.reference_frozen_s);
    // At a rail one code is what a sound sensor gives too: below F0 at the first, above the range at the
    // last.
    const bool rail = code[i] == 0 || code[i] == last_code;
    count(sensor_still_, code[i] == previous_code_ && !rail, o_.sensor_dead_s);
    if (rail && code[i] == 0 && force_N[i] > kLoaded_N) {
      o_.sensor_dead_s = std::max(o_.sensor_dead_s, static_cast<double>(++dead_run_) * period_s_);
    } else {
      dead_run_ = 0;
    }
    previous_force_N_ = force_N[i];
    previous_code_ = code[i];
    if (!wheel || !std::isfinite(theta[i])) continue;
    if (commanded != nullptr && theta[i] == previous_theta_) {
      const bool should_move =
          std::fabs(commanded[i]) > kCommandMoves_rad_per_s && !(status[i] & kRigTravelStop);
      theta_run_ = should_move ? theta_run_ + 1 : 0;
      o_.theta_still_while_commanded_s =
          std::max(o_.theta_still_while_commanded_s, static_cast<double>(theta_run_) * period_s_);
    } else {
      theta_run_ = 0;
    }
    previous_theta_ = theta[i];
    if (++spring_skip_ >= kSpringEvery) {
      spring_skip_ = 0;
      push_spring(block.t_s[i], theta[i], force_N[i]);
    }
  }
}

void RigWitness::push(const RigBlock& block, std::size_t n, const float* commanded) {
  if (n == 0) return;
  push_time(block, n);
  push_codes(block, n);
  push_force(block, n);
  push_motion(block, n, commanded);
}

RigObservation RigWitness::finish() const {
  RigWitness end = *this;
  end.close_spring_block();
  RigObservation o = end.o_;
  if (second_n_ > 0) o.reference_noise_N = std::sqrt(sum_second_ / (6.0 * static_cast<double>(second_n_)));
  if (force_n_ > 0) o.reference_mean_N = sum_force_ / static_cast<double>(force_n_);
  // A healthy converter toggles every bit below the highest one that its span needs.
  const unsigned span = o.samples > 0 && o.adc_max >= o.adc_min ? o.adc_max - o.adc_min : 0u;
  const unsigned expected = span > 3 ? (std::bit_floor(span) - 1u) : 0u;
  o.adc_bits_stuck = static_cast<std::uint16_t>(~(adc_or_ ^ adc_and_) & expected);
  const double n = static_cast<double>(o.spring_samples);
  if (o.spring_samples < 10) {
    o.spring_bias_N = o.spring_rms_N = o.spring_worst_bias_N = std::numeric_limits<double>::quiet_NaN();
    return o;
  }
  const double vx = sxx_ / n - (sx_ / n) * (sx_ / n);
  const double cxy = sxy_ / n - (sx_ / n) * (sy_ / n);
  const double vy = syy_ / n - (sy_ / n) * (sy_ / n);
  o.spring_bias_N = (sy_ - sx_) / n;
  o.spring_rms_N = std::sqrt(std::max(0.0, vy - 2.0 * cxy + vx));
  if (vx > 0.01) o.spring_slope = cxy / vx;
  return o;
}

}  // namespace forcegate
