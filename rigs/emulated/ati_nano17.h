#pragma once

#include <limits>

#include "hil/base/portable_math.h"
#include "hil/base/rng.h"

namespace forcegate::emulated {

/// Reference force cell in the manner of an ATI Nano17: one pole at 250 Hz ("exceeds 200 Hz"), white noise,
/// readings in steps of 0.025 N (Lebosse 2011, II-B), overload at the end of its range.
class AtiNano17 {
 public:
  struct Parameters {
    double resolution_N = 0.025;
    double noise_N = 0.006;  ///< standard deviation of one reading before rounding (ours)
    double bandwidth_Hz = 250.0;
    double overload_N = 17.0;
  };

  void begin(const Parameters& p, double step_s, double force_N) {
    p_ = p;
    follow_ = 1.0 - portable::exp(-6.28318530717958647693 * p.bandwidth_Hz * step_s);
    state_ = force_N;
    per_step_ = 1.0 / p.resolution_N;
    saturated_ = false;
  }

  /// `white` is a standard normal number.
  double read(double force_N, double white) {
    state_ += follow_ * (force_N - state_);
    double reading = gain_ * state_ + offset_N_ + p_.noise_N * white;
    saturated_ = reading >= p_.overload_N;
    if (saturated_) reading = p_.overload_N;
    // +4096 keeps the truncated number positive: rounding without a call.
    const auto steps = static_cast<int>(reading * per_step_ + 4096.5) - 4096;
    return static_cast<double>(steps) * p_.resolution_N;
  }

  bool saturated() const { return saturated_; }
  void set_offset_N(double offset) { offset_N_ = offset; }
  void set_gain(double gain) { gain_ = gain; }

 private:
  Parameters p_;
  double follow_ = 1.0, state_ = 0.0, per_step_ = 40.0, offset_N_ = 0.0, gain_ = 1.0;
  bool saturated_ = false;
};

}  // namespace forcegate::emulated
