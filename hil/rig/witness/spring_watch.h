#pragma once

#include <cstdint>
#include <span>

#include "hil/interface/rig.h"
#include "hil/rig/rig_observation.h"
#include "hil/rig/witness/group_means.h"
#include "hil/trace/lag_fit.h"

namespace forcegate::witness {

/// The spring as witness of the ATI: its force against F = k (preload + e (1 - cos theta)), theta read back from the drive, and which of
/// spring, ATI and sensor is late.
class SpringWatch {
 public:
  static constexpr std::uint64_t kLeastSamples = 10;  ///< fewer tell nothing of the spring

  SpringWatch() = default;
  explicit SpringWatch(const RigInfo& info);
  void push(std::span<const GroupMean> groups);
  /// NaN below kLeastSamples groups with an angle, which a rig without a wheel never has.
  void finish(RigObservation& o) const;

 private:
  void close_block();

  RigGeometry geometry_;
  double last_code_ = 65535.0;
  std::uint64_t n_ = 0;
  double sx_ = 0, sy_ = 0, sxx_ = 0, sxy_ = 0, syy_ = 0;
  double block_n_ = 0, block_bias_ = 0, worst_bias_N_ = 0;
  LagFit reference_lag_, sensor_lag_;
};

}  // namespace forcegate::witness
