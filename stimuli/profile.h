#pragma once
// What the profiles share: storage of facts, the loading ramp, parameter rows and sines on a sample grid.

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "hil/base/portable_math.h"
#include "hil/base/text.h"
#include "hil/interface/stimulus.h"

namespace forcegate::stimuli {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * kPi;
inline constexpr double kRequired = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kForceLimit_N = 20.0;
inline constexpr double kLongest_s = 1e6;

/// 0 before 0, 1 after 1, raised cosine between.
inline double smooth_step(double x) {
  if (x <= 0.0) return 0.0;
  if (x >= 1.0) return 1.0;
  return 0.5 - 0.5 * portable::cos(kPi * x);
}

/// A profile with a loading ramp before it: from 0 N to `low_N` in ramp_s as a raised cosine. ramp_s = 0: the
/// record begins at low_N, which is where the rig stands then.
class Profile : public Stimulus {
 public:
  double duration_s() const override { return duration_s_; }
  StimulusFacts facts() const override { return facts_; }
  double force_N(double t_s) const final {
    if (t_s < ramp_s_) return low_N_ * smooth_step(t_s / ramp_s_);
    return profile_N(t_s - ramp_s_);
  }

 protected:
  /// Set-point `since_s` after the loading ramp.
  virtual double profile_N(double since_s) const = 0;

  void set_ramp(double ramp_s, double low_N) {
    ramp_s_ = ramp_s;
    low_N_ = low_N;
    facts_.excitation_start_s = ramp_s;
    facts_.minimum_N = ramp_s > 0.0 ? std::min(0.0, low_N) : low_N;
  }

  double duration_s_ = 0.0, ramp_s_ = 0.0, low_N_ = 0.0;
  StimulusFacts facts_;
};

/// amplitude * cos(2 pi f t + phase) at t = k step_s, added to out[0..n) for k = first, first + 1 ...
/// Rotation by recurrence that starts anew at every multiple of kAnchor, so the value depends on k alone and
/// not on the call.
inline void add_cosine(double amplitude, double f_Hz, double phase_rad, std::int64_t first, double step_s,
                       std::size_t n, double* out) {
  constexpr std::int64_t kAnchor = 32;
  const double turn = kTwoPi * f_Hz * step_s;
  const double rotate_re = portable::cos(turn), rotate_im = portable::sin(turn);
  const std::int64_t last = first + static_cast<std::int64_t>(n);
  for (std::int64_t anchor = first - first % kAnchor; anchor < last; anchor += kAnchor) {
    const double angle = kTwoPi * f_Hz * (static_cast<double>(anchor) * step_s) + phase_rad;
    double re = amplitude * portable::cos(angle), im = amplitude * portable::sin(angle);
    const std::int64_t stop = std::min(anchor + kAnchor, last);
    for (std::int64_t k = anchor; k < stop; ++k) {
      if (k >= first) out[k - first] += re;
      const double next = re * rotate_re - im * rotate_im;
      im = re * rotate_im + im * rotate_re;
      re = next;
    }
  }
}

/// Index of first_t_s on the grid of step_s, or -1 when it does not lie on it.
inline std::int64_t grid_index(double first_t_s, double step_s) {
  const double k = first_t_s / step_s;
  if (!(k >= 0.0 && k < 1e12)) return -1;
  const double nearest = std::floor(k + 0.5);
  return std::abs(k - nearest) < 1e-6 ? static_cast<std::int64_t>(nearest) : -1;
}

inline StimulusParameter mean_parameter() {
  return {"m_N", "N", kRequired, 0.0, kForceLimit_N, "middle force m"};
}
inline StimulusParameter amplitude_parameter() {
  return {"A_N", "N", kRequired, 0.0, kForceLimit_N, "amplitude A, half of peak to peak"};
}
inline StimulusParameter duration_parameter(double fallback_s) {
  return {"duration_s", "s", fallback_s, 1e-3, kLongest_s, "length of the record, loading ramp included"};
}
inline StimulusParameter ramp_parameter() {
  return {"ramp_s", "s", 0.0, 0.0, 1e4, "loading from 0 N to the lowest force; 0 = the record begins there"};
}

/// The paper's condition m >= A (eq. 2): the sensor stays loaded.
inline Result<void> check_contact(const std::string& name, double lowest_N) {
  if (lowest_N >= -1e-12) return {};
  return fail(ErrorCode::usage,
              "stimulus '" + name + "' would pull: its lowest force is " + shortest(lowest_N) + " N", {},
              "raise m_N or lower the amplitude (m >= A)");
}

}  // namespace forcegate::stimuli
