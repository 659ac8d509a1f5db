#include "rigs/emulated/rc_sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "hil/base/portable_math.h"

namespace forcegate::emulated {
namespace {

constexpr double kRange_N = 250.0;
constexpr double kGapLever = 5.0;     // lambda = 2 kappa s, a gap of some 0.9 nm behind a barrier of 0.3 eV
constexpr double kCommonShare = 0.5;  // of the variance of what does not repeat in the conductance
constexpr double kGainShare = 0.5;    // of each part's variance: from loading to loading; the rest are slips
constexpr double kSlip_N = 40.0;      // force over which a slip is forgotten
constexpr double kSlipChance = 0.08;  // per newton of added weight
constexpr double kPlay_N = 4.0;
constexpr double kForgotten_s = 7200.0;  // "almost 2 h are necessary" (Lebosse 2011)
constexpr double kCreepStart_s = 1.0, kRecovery_s = 600.0;

// Band of relaxations: its lower end lies above the frequency where the departure is seen, since the loss sets in as f^2.
constexpr double kOnsetPerDivergence = 1.0 / 0.53;  // the loss has grown to a sixth to a fifth of G there
constexpr double kBandRatio = 1.4;
constexpr int kRelaxations = 10;
constexpr double kOnsetForceSlope =
    0.03;  // "only slight variation of the divergent frequency is noticed as force changes"

double cut_normal(Rng& rng) {
  double z = rng.normal();
  while (std::abs(z) > 2.0) z = rng.normal();
  return z;
}

double line(double force_N, double bend) {
  return force_N + 4.0 * bend * force_N * (kRange_N - force_N) / kRange_N;
}

}  // namespace

RcSpecimen draw_rc_specimen(std::uint64_t seed, std::uint64_t set, std::uint64_t sensor) {
  Rng rng(seed, "rc_specimen/" + std::to_string(set) + "/" + std::to_string(sensor));
  RcSpecimen s;
  s.g_S_per_N *= 1.0 + 0.20 * cut_normal(rng);
  s.c0_F *= 1.0 + 0.08 * cut_normal(rng);
  s.c_F_per_N *= 1.0 + 0.10 * cut_normal(rng);
  s.bend_g = 0.0070 * cut_normal(rng);
  s.bend_c = 0.0039 * cut_normal(rng);
  s.divergence_Hz = rng.uniform(4500.0, 7000.0);
  s.repeat_g_N = 0.635 * portable::exp(0.35 * cut_normal(rng));
  s.repeat_c_N = 0.356 * portable::exp(0.15 * cut_normal(rng));
  s.creep_per_decade *= 1.0 + 0.3 * cut_normal(rng);
  s.play_share *= 1.0 + 0.3 * cut_normal(rng);
  return s;
}

void RcSensor::begin(const RcSpecimen& specimen, Rng rng, double rest_before_s) {
  residue_N_ = rest_before_s < kForgotten_s ? creep_N() * portable::exp(-rest_before_s / kRecovery_s) : 0.0;
  p_ = specimen;
  rng_ = rng;
  force_N_ = play_N_ = time_s_ = 0.0;
  increments_.clear();
  slip_common_N_ = slip_g_N_ = slip_c_N_ = 0.0;
  const double common_in_c_N = p_.repeat_g_N * std::sqrt(kCommonShare) / kGapLever;
  own_c_N_ = std::sqrt(std::max(p_.repeat_c_N * p_.repeat_c_N - common_in_c_N * common_in_c_N,
                                0.09 * p_.repeat_c_N * p_.repeat_c_N));
  // A relative error d of the gain has the rms d F_max / sqrt(3) over an even range.
  const double per_newton = std::sqrt(3.0 * kGainShare) / kRange_N;
  gain_common_ = p_.repeat_g_N * std::sqrt(kCommonShare) * per_newton * cut_normal(rng_);
  gain_g_ = p_.repeat_g_N * std::sqrt(1.0 - kCommonShare) * per_newton * cut_normal(rng_);
  gain_c_ = own_c_N_ * per_newton * cut_normal(rng_);
}

void RcSensor::load(double force_N, double hold_s) {
  const double step_N = force_N - force_N_;
  if (step_N != 0.0) {
    const double moved_N = std::abs(step_N);
    const double keep = portable::exp(-moved_N / kSlip_N), renewed = std::sqrt(1.0 - keep * keep);
    const double chance = 1.0 - portable::exp(-kSlipChance * moved_N);
    const auto slip = [&](double& value_N, double rms_N) {
      value_N *= keep;
      const bool slips = rng_.uniform() < chance;
      const double size = rng_.normal();
      if (slips) value_N += rms_N * std::sqrt(1.0 - kGainShare) * renewed / std::sqrt(chance) * size;
    };
    slip(slip_common_N_, p_.repeat_g_N * std::sqrt(kCommonShare));
    slip(slip_g_N_, p_.repeat_g_N * std::sqrt(1.0 - kCommonShare));
    slip(slip_c_N_, own_c_N_);
    increments_.push_back({step_N, time_s_});
    force_N_ = force_N;
    play_N_ = std::clamp(play_N_, force_N_ - kPlay_N, force_N_ + kPlay_N);
  }
  time_s_ += hold_s;
}

double RcSensor::creep_N() const {
  double decades = 0.0;
  for (const Increment& i : increments_)
    decades += i.force_N * portable::log(1.0 + (time_s_ - i.at_s) / kCreepStart_s);
  return p_.creep_per_decade * decades / 2.302585092994046 + residue_N_;
}

RcState RcSensor::state() const {
  const double held_N = force_N_ + p_.play_share * (play_N_ - force_N_);
  const double common_N = gain_common_ * held_N + slip_common_N_ + creep_N();
  const double at_g_N = held_N + common_N + gain_g_ * held_N + slip_g_N_;
  const double at_c_N = held_N + common_N / kGapLever + gain_c_ * held_N + slip_c_N_;
  return {std::max(p_.g_S_per_N * line(at_g_N, p_.bend_g), 1e-9),
          p_.c0_F + p_.c_F_per_N * line(at_c_N, p_.bend_c)};
}

std::complex<double> RcSensor::admittance_S(double f_Hz) const {
  const RcState s = state();
  const double w = 2.0 * std::numbers::pi * f_Hz;
  const double onset_Hz = p_.divergence_Hz * kOnsetPerDivergence *
                          (1.0 + kOnsetForceSlope * portable::log(std::max(force_N_, 1.0) / 125.0));
  // Loss of the whole band far above its lower end: G f / onset, so that tan(phi) stays where it was at the onset.
  double each_F = 2.0 / std::numbers::pi * s.conductance_S / (2.0 * std::numbers::pi * onset_Hz) * portable::log(kBandRatio);
  each_F = std::min(each_F, 0.8 * s.capacitance_F / kRelaxations);
  std::complex<double> y{s.conductance_S, w * (s.capacitance_F - kRelaxations * each_F)};
  double relaxation_Hz = onset_Hz;
  for (int k = 0; k < kRelaxations; ++k, relaxation_Hz *= kBandRatio)
    y += std::complex<double>{0.0, w * each_F} / std::complex<double>{1.0, f_Hz / relaxation_Hz};
  return y;
}

}  // namespace forcegate::emulated
