#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "hil/interface/rig.h"
#include "hil/rig/rig_observation.h"

namespace forcegate::witness {

/// The drive against its command: theta against the integral of the commanded velocity. A sound drive of first order lags by tau v, so what
/// is judged is the residual of (integral of command - theta) = tau v + const over stretches inside the travel. When a
/// command takes effect is known to one control period only: a command that steps by dv may show T dv of that as residual.
class DriveWatch {
 public:
  explicit DriveWatch(double period_s = 1e-3) : period_s_(period_s) {}
  /// Of a rig with a wheel; `commanded`: rad/s that it was told for each of the n rows.
  template <bool kSound>
  void push(const RigBlock& block, std::size_t n, const float* commanded_rad_per_s);
  /// following_rad stays NaN up to 100 rows in motion.
  void finish(RigObservation& o) const;

 private:
  double period_s_;
  // e = integral of command - theta, v = theta', both through the same high pass.
  double e_ = 0, v_ = 0, previous_v_ = 0;
  float last_theta_ = std::numeric_limits<float>::quiet_NaN();
  double n_ = 0, ee_ = 0, ev_ = 0, vv_ = 0;
  float previous_command_ = 0.0f;
  double command_steps_ = 0, command_rows_ = 0;
  float previous_theta_ = 0.0f;
  std::uint64_t still_run_ = 0;
  double still_s_ = 0.0;
};

}  // namespace forcegate::witness
