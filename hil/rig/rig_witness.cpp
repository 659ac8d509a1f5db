#include "hil/rig/rig_witness.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace forcegate {
namespace {
constexpr int kSpringEvery = 10;  // cos() of one sample in ten: the witness is about levels, not edges
constexpr double kMoved_N = 0.1;      // four resolutions of the Nano17
constexpr float kLoaded_N = 0.6f;     // above the offset F0 of any sensor of the kind
constexpr float kCommandMoves_rad_per_s = 0.05f;
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
  return g.spring_N_per_mm * (g.preload_mm + g.eccentricity_mm * (1.0 - std::cos(theta_rad)));
}

// The cosines are asked for only once in 32 samples of a run that is already suspicious.
bool RigWitness::moved(Still& still, float theta_rad) const {
  if (!still.moved && still.run % 32 == 0)
    still.moved = std::fabs(spring_N(theta_rad) - spring_N(still.theta_rad)) > kMoved_N;
  return still.moved;
}

void RigWitness::watch_still(std::uint16_t code, float force_N, float theta_rad) {
  const auto count = [&](Still& still, bool same, double& longest_s) {
    if (!same) {
      still = {0, theta_rad, false};
      return;
    }
    ++still.run;
    if (moved(still, theta_rad)) longest_s = std::max(longest_s, static_cast<double>(still.run) * period_s_);
  };
  count(reference_still_, valid_run_ > 0 && force_N == x1_, o_.reference_frozen_s);
  o_.reference_still_s = std::max(o_.reference_still_s, static_cast<double>(reference_still_.run) * period_s_);
  // At a rail one code is what a sound sensor gives too: below F0 at the first, above the range at the last.
  const bool rail = code == 0 || code == (1u << info_.adc_bits) - 1u;
  count(sensor_still_, code == previous_code_ && !rail, o_.sensor_dead_s);
  previous_code_ = code;
  dead_run_ = code == 0 && force_N > kLoaded_N ? dead_run_ + 1 : 0;
  o_.sensor_dead_s = std::max(o_.sensor_dead_s, static_cast<double>(dead_run_) * period_s_);
}

void RigWitness::push_spring(double theta_rad, double force_N) {
  const double spring_N = this->spring_N(theta_rad);
  ++o_.spring_samples;
  sx_ += spring_N;
  sy_ += force_N;
  sxx_ += spring_N * spring_N;
  sxy_ += spring_N * force_N;
  syy_ += force_N * force_N;
  if (o_.last_t_s - block_start_s_ >= kBlockSeconds) {
    close_spring_block();
    block_start_s_ = o_.last_t_s;
    block_sum_ = 0.0;
    block_n_ = 0;
  }
  block_sum_ += force_N - spring_N;
  ++block_n_;
}

void RigWitness::push(const RigBlock& block, std::size_t n, const float* commanded) {
  constexpr std::uint16_t kReferenceBad = kRigReferenceSaturated | kRigReferenceFault;
  const bool wheel = info_.geometry.eccentricity_mm > 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t_s = block.t_s[i];
    if (o_.samples++ == 0) {
      o_.first_t_s = t_s;
      block_start_s_ = t_s;
    } else {
      const double step_s = t_s - previous_t_s_;
      if (!(step_s > 0.0)) ++o_.time_not_monotone;
      if (step_s > 1.5 * period_s_) ++o_.time_gaps;
      o_.worst_step_s = std::max(o_.worst_step_s, std::fabs(step_s - period_s_));
    }
    previous_t_s_ = t_s;
    o_.last_t_s = t_s;

    const std::uint16_t status = block.status[i];
    if (status != 0) {
      o_.lost += (status & kRigSampleLost) != 0;
      o_.reference_saturated += (status & kRigReferenceSaturated) != 0;
      o_.reference_fault += (status & kRigReferenceFault) != 0;
      o_.motor_fault += (status & kRigMotorFault) != 0;
      o_.travel_stop += (status & kRigTravelStop) != 0;
      o_.adc_rail += (status & kRigAdcRail) != 0;
    }
    const std::uint16_t code = block.adc[i];
    o_.adc_min = std::min(o_.adc_min, code);
    o_.adc_max = std::max(o_.adc_max, code);
    adc_or_ |= code;
    adc_and_ &= code;

    const float force_N = block.force_ref_N[i];
    const float theta = block.theta_rad[i];
    if (!std::isfinite(force_N)) {
      o_.reference_not_finite += (status & kRigSampleLost) == 0;  // a lost row is the link's
      valid_run_ = 0;
      continue;
    }
    if (status & kReferenceBad) {
      valid_run_ = 0;
      continue;
    }
    o_.reference_min_N = std::min(o_.reference_min_N, static_cast<double>(force_N));
    o_.reference_max_N = std::max(o_.reference_max_N, static_cast<double>(force_N));
    sum_force_ += force_N;
    ++force_n_;
    watch_still(code, force_N, theta);
    if (valid_run_ >= 2) {
      const double second = static_cast<double>(x2_) - 2.0 * x1_ + force_N;
      sum_second_ += second * second;
      ++second_n_;
    }
    x2_ = x1_;
    x1_ = force_N;
    ++valid_run_;

    if (!wheel || !std::isfinite(theta)) continue;
    if (commanded != nullptr) {
      const bool should_move = std::fabs(commanded[i]) > kCommandMoves_rad_per_s && !(status & kRigTravelStop);
      theta_run_ = should_move && theta == previous_theta_ ? theta_run_ + 1 : 0;
      o_.theta_still_while_commanded_s =
          std::max(o_.theta_still_while_commanded_s, static_cast<double>(theta_run_) * period_s_);
    }
    previous_theta_ = theta;
    if (++spring_skip_ >= kSpringEvery) {
      spring_skip_ = 0;
      push_spring(theta, force_N);
    }
  }
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
