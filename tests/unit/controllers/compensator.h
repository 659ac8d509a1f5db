#pragma once
// The smallest compensator by eq. (7) that closes the loop in these tests. Not the firmware: it is told
// f_min, and takes U_min and A from the first two cycles.

#include <algorithm>
#include <cstdint>

#include "hil/base/portable_math.h"
#include "rigs/emulated/population.h"

namespace forcegate::test {

enum class Level { off, nominal, statical, identified };

class Compensator {
 public:
  Compensator(Level level, const emulated::Specimen& specimen, const emulated::FilmParameters& film,
              double f_min_Hz)
      : on_(level != Level::off), window_s_(2.2 / f_min_Hz) {
    const bool measured = level != Level::nominal;
    gain_ = measured ? film.gain_N_per_V : emulated::kNominalGain_N_per_V;
    offset_ = measured ? film.offset_N : emulated::kNominalOffset_N;
    b_per_s_ = 0.0019 * f_min_Hz + 0.0056;
    if (level == Level::identified) {
      b_per_s_ *= specimen.b_scale;
      q_scale_ = specimen.q_scale;
    }
  }

  double operator()(std::uint16_t code) {
    const double t_s = 1e-3 * static_cast<double>(count_++);
    const double force_N = gain_ * (static_cast<double>(code) * 10.0 / 65535.0) + offset_;
    if (!on_) return force_N;
    low_N_ = std::min(low_N_, force_N);
    if (t_s < window_s_) {
      high_N_ = std::max(high_N_, force_N);
      const double A_N = 0.5 * (high_N_ - low_N_);
      q_ = q_scale_ / (1.0 + 1.377 * A_N * A_N);
    }
    if (count_ % 10 == 1) decayed_ = portable::exp(-b_per_s_ * t_s);
    return low_N_ + (1.0 + q_) / (decayed_ + q_) * (force_N - low_N_);
  }

 private:
  bool on_;
  double window_s_, gain_, offset_, b_per_s_ = 0.0, q_scale_ = 1.0, q_ = 1.0, decayed_ = 1.0;
  double low_N_ = 1e9, high_N_ = -1e9;
  std::int64_t count_ = 0;
};

}  // namespace forcegate::test
