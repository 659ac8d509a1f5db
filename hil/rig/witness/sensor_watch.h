#pragma once

#include <cstdint>
#include <span>

#include "hil/interface/rig.h"
#include "hil/rig/rig_observation.h"
#include "hil/rig/witness/group_means.h"

namespace forcegate::witness {

/// The sensor against the ATI: within 10 s the film's loss hardly changes, so its code must follow the ATI in a straight line.
class SensorWatch {
 public:
  SensorWatch() = default;
  explicit SensorWatch(const RigInfo& info);
  void push(std::span<const GroupMean> groups);
  void finish(RigObservation& o) const;

 private:
  struct Block {
    double n = 0, f = 0, c = 0, ff = 0, fc = 0, cc = 0, code_low = 1e9, code_high = -1e9;
  };
  void close_block();

  double last_code_ = 65535.0;
  Block block_;
  std::uint64_t blocks_ = 0, odd_ = 0;
};

}  // namespace forcegate::witness
