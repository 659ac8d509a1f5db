#pragma once
// Watches the rig, not the firmware, while a record streams past. What it sees decides whether the record may
// be used to judge a build at all (hil/rig/self_check.h). Each watch in hil/rig/witness looks at one thing.

#include <cstddef>
#include <limits>

#include "hil/interface/rig.h"
#include "hil/rig/rig_observation.h"
#include "hil/rig/witness/change_watch.h"
#include "hil/rig/witness/code_watch.h"
#include "hil/rig/witness/drive_watch.h"
#include "hil/rig/witness/group_means.h"
#include "hil/rig/witness/noise_watch.h"
#include "hil/rig/witness/sensor_watch.h"
#include "hil/rig/witness/spring_watch.h"
#include "hil/rig/witness/time_watch.h"

namespace forcegate {

class RigWitness {
 public:
  void begin(const RigInfo& info);
  /// Rows [0, n) of the block; commanded is the velocity the rig was told for each of them (may be null).
  void push(const RigBlock& block, std::size_t n, const float* commanded_rad_per_s = nullptr);
  /// Unloaded readings, when the rig can take them.
  void zero_before(const ReferenceZero& zero) {
    if (zero.n > 0) zero_start_N_ = zero.mean_N;
  }
  void zero_after(const ReferenceZero& zero) {
    if (zero.n > 0) zero_end_N_ = zero.mean_N;
  }
  RigObservation finish() const;

 private:
  template <bool kSound>
  void push_rows(const RigBlock& block, std::size_t n, const float* commanded_rad_per_s);

  bool wheel_ = false;
  double zero_start_N_ = std::numeric_limits<double>::quiet_NaN(), zero_end_N_ = std::numeric_limits<double>::quiet_NaN();
  witness::TimeWatch time_;
  witness::CodeWatch codes_;
  witness::NoiseWatch noise_;
  witness::ChangeWatch changes_;
  witness::GroupMeans groups_;
  witness::SpringWatch spring_;
  witness::SensorWatch sensor_;
  witness::DriveWatch drive_;
};

}  // namespace forcegate
