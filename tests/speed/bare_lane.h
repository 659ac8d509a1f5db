#pragma once
// The limit for the native lane: the same arithmetic in one plain loop. Physics of the emulated rig, integral
// force control, the firmware's own function, the independent implementation beside it, per-cycle extrema of
// three channels as means of 11 samples, spring witness, noise of the reference, digest of the same bytes.
// No blocks beyond one control period, no checks of errors, no interfaces, nothing kept but sums.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "golden/compare/lebosse_oracle.h"
#include "hil/base/digest.h"
#include "hil/base/portable_math.h"
#include "rigs/emulated/ati_nano17.h"
#include "rigs/emulated/converter.h"
#include "rigs/emulated/film.h"
#include "rigs/emulated/motor.h"
#include "rigs/emulated/population.h"
#include "rigs/emulated/spring.h"
#include "rigs/emulated/wheel.h"
#include "rigs/emulated/white_noise.h"

namespace forcegate::speed {

using FirmwareStep = std::int32_t (*)(std::uint32_t first, std::uint32_t n, const std::uint16_t* adc,
                                      float* force_N, std::uint8_t* flags);

/// Sine m + A sin 2 pi f t in closed loop over `samples` at 1 kHz; returns a number that depends on everything.
inline double bare_lane(std::uint64_t samples, const Calibration& calibration, FirmwareStep step) {
  using namespace emulated;
  constexpr double kStep_s = 1e-3, kMean_N = 2.15, kAmplitude_N = 1.05, kOmega = 3.14159265358979;
  constexpr std::size_t kPeriod = 10, kBlock = 4090, kMean = 11;
  EccentricWheel wheel;
  Spring spring;
  wheel.set_eccentricity_mm(10.4);
  VelocityMotor motor;
  double force_N = kMean_N, wanted = wheel.angle_rad(force_N / spring.stiffness_N_per_mm);
  motor.begin({}, kStep_s, wanted);
  const double k_per_mm = spring.stiffness_N_per_mm, slope = k_per_mm * wheel.eccentricity_mm();
  AtiNano17 ati;
  ati.begin({}, kStep_s, force_N);
  Converter converter;
  converter.begin({});
  Film film;
  const auto specimen = find_specimen("nominal");
  film.begin(draw_session(SensorType::flexiforce, *specimen, 1, 0), kStep_s, force_N, 0.7, 7200.0, 1);
  WhiteNoise ati_noise(1, "ati_noise"), adc_noise(1, "adc_noise");
  LebosseOracle oracle(calibration);

  std::array<double, kPeriod> force{}, volts{};
  std::vector<float> theta(kBlock), reference(kBlock), output(kBlock);
  std::vector<std::uint16_t> adc(kBlock), status(kBlock);
  std::vector<std::uint8_t> flags(kBlock);
  SampleDigest digest;
  double estimate = force_N, worst = 0.0, sum_spring = 0.0, sum_square = 0.0, sum_second = 0.0,
         sum_error = 0.0;
  std::array<std::array<double, kMean>, 3> ring{};
  std::array<double, 3> mean{}, high{-1e9, -1e9, -1e9}, low{1e9, 1e9, 1e9};
  double x1 = 0.0, x2 = 0.0, total = 0.0;
  std::size_t at = 0, slot = 0;
  const double per_code = calibration.gain_N_per_V * calibration.v_range_V / 65535.0;
  for (std::uint64_t i = 0; i < samples; i += kPeriod) {
    const double t_s = static_cast<double>(i) * kStep_s;
    const double set_N = kMean_N + kAmplitude_N * portable::sin(kOmega * t_s);
    const double rate = 20.0 * (set_N - estimate) / slope;
    motor.command(rate + 30.0 * (wanted - motor.theta_rad()));
    wanted += rate * 0.01;
    for (std::size_t k = 0; k < kPeriod; ++k) {
      const double angle = motor.step();
      theta[at + k] = static_cast<float>(angle);
      status[at + k] = motor.at_stop();
      force[k] = spring.force_N(wheel.travel_mm(angle));
    }
    film.run(kPeriod, force.data(), volts.data());
    for (std::size_t k = 0; k < kPeriod; ++k) {
      reference[at + k] = static_cast<float>(ati.read(force[k], ati_noise.next()));
      adc[at + k] = converter.convert(volts[k], adc_noise.next());
    }
    film.tick(0.01);
    if (step(static_cast<std::uint32_t>(i), kPeriod, adc.data() + at, output.data() + at,
             flags.data() + at) != 0)
      return 0.0;
    estimate = output[at + kPeriod - 1];
    for (std::size_t k = at; k < at + kPeriod; ++k) {
      const auto expected = oracle.step(adc[k]);
      worst = std::max(worst, std::fabs(output[k] - expected.force_N) + ((expected.flags ^ flags[k]) & 1));
      const double x = reference[k];
      const std::array<double, 3> value{x, output[k], per_code * adc[k] + calibration.offset_N};
      for (std::size_t c = 0; c < 3; ++c) {
        mean[c] += value[c] - ring[c][slot];
        ring[c][slot] = value[c];
        high[c] = std::max(high[c], mean[c]);
        low[c] = std::min(low[c], mean[c]);
      }
      if (++slot == kMean) slot = 0;
      const double second = x2 - 2.0 * x1 + x;
      sum_second += second * second;
      x2 = x1;
      x1 = x;
      sum_error += std::fabs(output[k] - x);
    }
    const double held = k_per_mm * wheel.travel_mm(theta[at]);
    sum_spring += reference[at] - held;
    sum_square += held * held;
    if (i % 1000 == 0)  // a turning point of this profile
      for (std::size_t c = 0; c < 3; ++c) {
        total += high[c] - low[c];
        high[c] = -1e9;
        low[c] = 1e9;
      }
    at += kPeriod;
    if (at == kBlock || i + kPeriod >= samples) {
      digest.update(adc.data(), at * sizeof(std::uint16_t));
      digest.update(reference.data(), at * sizeof(float));
      digest.update(theta.data(), at * sizeof(float));
      digest.update(status.data(), at * sizeof(std::uint16_t));
      digest.update(output.data(), at * sizeof(float));
      digest.update(flags.data(), at);
      at = 0;
    }
  }
  return worst + sum_spring + sum_square + sum_second + sum_error + total +
         static_cast<double>(digest.hex()[0]);
}

}  // namespace forcegate::speed
