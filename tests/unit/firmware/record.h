#pragma once
// Raw codes of a sensor that decays by eq. (3) in ratio form, for tests of the firmware without a rig.

#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "hil/base/portable_math.h"
#include "hil/base/rng.h"

namespace forcegate::test {

struct Decay {
  double amplitude_N = 1.05, mean_N = 2.15, f_Hz = 0.5, duration_s = 1200.0, noise_V = 0.0015;
  double gain_N_per_V = 0.5, offset_N = 0.15, b_scale = 1.0, q_scale = 1.0;
};

struct Record {
  std::vector<std::uint16_t> adc;
  std::vector<double> force_N;  ///< truth
};

inline std::uint16_t to_code(double voltage_V) {
  const double code = voltage_V * 6553.5 + 0.5;
  return static_cast<std::uint16_t>(code < 0 ? 0 : code > 65535 ? 65535 : code);
}

inline Record decaying_sine(const Decay& d, std::uint64_t seed = 1) {
  Record r;
  Rng rng(seed, "adc");
  const double b = d.b_scale * (0.0019 * d.f_Hz + 0.0056);
  const double q = d.q_scale / (1.0 + 1.377 * d.amplitude_N * d.amplitude_N);
  const double low_V = (d.mean_N - d.amplitude_N - d.offset_N) / d.gain_N_per_V;
  for (int i = 0; i < static_cast<int>(d.duration_s * 1000.0); ++i) {
    const double t = i * 1e-3;
    const double force = d.mean_N - d.amplitude_N * portable::cos(6.283185307179586 * d.f_Hz * t);
    const double keep = (portable::exp(-b * t) + q) / (1.0 + q);
    const double voltage = low_V + keep * ((force - d.offset_N) / d.gain_N_per_V - low_V);
    r.adc.push_back(
        to_code(voltage + d.noise_V * (rng.uniform() + rng.uniform() + rng.uniform() - 1.5) * 2.0));
    r.force_N.push_back(force);
  }
  return r;
}

}  // namespace forcegate::test
