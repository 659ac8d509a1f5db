#include "hil/rig/witness/drive_watch.h"

#include <algorithm>
#include <cmath>

#include "hil/rig/witness/rows.h"

namespace forcegate::witness {
namespace {
constexpr float kCommandMoves_rad_per_s = 0.05f;
constexpr double kCommandPeriod_s = 0.01;  // commands come at this distance
constexpr double kForget_s = 1.0;          // what the drive's gain error adds up to is forgotten
}  // namespace

// e = integral of (command - theta'), v = theta'. Both sides pass the same leak, so e = tau v of a sound drive stays true;
// at a stop the sums begin anew.
template <bool kSound>
void DriveWatch::push(const RigBlock& block, std::size_t n, const float* commanded) {
  const float *force_N = block.force_ref_N.data(), *theta = block.theta_rad.data();
  const std::uint16_t* status = block.status.data();
  const double per_period = 1.0 / period_s_, keep = 1.0 - period_s_ / kForget_s;
  double e = e_, v_high = v_, previous_v = previous_v_, last = last_theta_;
  double count = 0.0, ee = 0.0, ev = 0.0, vv = 0.0;
  float previous = previous_theta_;
  std::uint64_t still = still_run_, longest = 0;
  command_rows_ += static_cast<double>(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double step = static_cast<double>(commanded[i]) - static_cast<double>(previous_command_);
    command_steps_ += step * step;
    previous_command_ = commanded[i];
    if (!kSound && no_reference(force_N[i], status[i])) {
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
  e_ = e, v_ = v_high, previous_v_ = previous_v, last_theta_ = static_cast<float>(last);
  n_ += count, ee_ += ee, ev_ += ev, vv_ += vv;
  previous_theta_ = previous;
  still_run_ = still;
  still_s_ = std::max(still_s_, static_cast<double>(longest) * period_s_);
}
template void DriveWatch::push<true>(const RigBlock&, std::size_t, const float*);
template void DriveWatch::push<false>(const RigBlock&, std::size_t, const float*);

void DriveWatch::finish(RigObservation& o) const {
  o.theta_still_while_commanded_s = still_s_;
  if (command_rows_ > 0.0)
    o.command_step_rad = kCommandPeriod_s * std::sqrt(command_steps_ / (command_rows_ * period_s_ / kCommandPeriod_s));
  if (n_ > 100.0) o.following_rad = std::sqrt(std::max(0.0, ee_ - (vv_ > 0.0 ? ev_ * ev_ / vv_ : 0.0)) / n_);
}

}  // namespace forcegate::witness
