#pragma once
// How far the wheel of a rig without a drive's lag is behind the profile that is played on it.

#include "hil/interface/stimulus.h"
#include "tests/support/fake_rig.h"

namespace forcegate::testing {

/// Least squares of profile - force = lag d(profile)/dt from the third second on. The open-loop controller leaves a drive 8 ms.
class FollowingLag {
 public:
  FollowingLag(FakeRig& rig, const Stimulus& stimulus) {
    rig.spoil = [&](std::size_t row, double t_s, RigBlock& block) {
      if (t_s < 3.0) return;
      const double at_s = t_s + 1.0 / rig.info().rate_Hz;  // a row is of the end of its step
      const double slope = (stimulus.force_N(at_s + 1e-3) - stimulus.force_N(at_s - 1e-3)) / 2e-3;
      off_ += (stimulus.force_N(at_s) - static_cast<double>(block.force_ref_N[row])) * slope;
      slopes_ += slope * slope;
    };
  }
  double s() const { return off_ / slopes_; }

 private:
  double off_ = 0.0, slopes_ = 0.0;
};

}  // namespace forcegate::testing
