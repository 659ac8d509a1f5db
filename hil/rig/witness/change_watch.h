#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "hil/interface/rig.h"
#include "hil/rig/rig_observation.h"

namespace forcegate::witness {

/// Readings from one row to the next: those that do not change while the spring moves, codes at the rail under load, a signal cut off before
/// the converter, jumps of the code while the reference stands.
class ChangeWatch {
 public:
  ChangeWatch() = default;
  explicit ChangeWatch(const RigInfo& info);
  template <bool kSound>
  void push(const RigBlock& block, std::size_t n);
  /// `largest_code` of the record.
  void finish(std::uint16_t largest_code, RigObservation& o) const;

 private:
  /// How long a reading has not changed, and whether its witness has moved meanwhile.
  struct Still {
    std::uint64_t run = 0;
    float witness = 0.0f;
    bool moved = false;
  };
  enum class Witness { wheel_rad, force_N, code };
  bool moves(Witness witness, float from, float to, double enough_N) const;
  void examine(Still& still, Witness witness, float now, double enough_N, double& longest_s) const;

  RigGeometry geometry_;
  double period_s_ = 1e-3;
  double sensor_moved_N_ = 0.1;  ///< what a living channel cannot sleep through: some steps of its converter
  std::uint16_t last_code_ = 0xFFFF;
  float previous_force_N_ = std::numeric_limits<float>::quiet_NaN();
  std::uint16_t previous_code_ = 0, clip_code_ = 0;
  double clip_s_ = 0.0;
  Still reference_, sensor_;
  double reference_frozen_s_ = 0.0, reference_stale_s_ = 0.0, sensor_dead_s_ = 0.0, sensor_stale_s_ = 0.0;
  std::uint64_t dead_run_ = 0, jumps_ = 0;
};

}  // namespace forcegate::witness
