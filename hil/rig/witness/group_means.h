#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "hil/interface/rig.h"

namespace forcegate::witness {

/// Mean of kGroup rows, t_s of the last of them.
struct GroupMean {
  double t_s, theta_rad, force_N, code;
  bool begins_block;  ///< of kBlockSeconds
};

/// Rows with a force of the reference in groups: the spring's force of one sample in ten, as its witness is about levels, not edges.
class GroupMeans {
 public:
  static constexpr int kGroup = 10;
  static constexpr double kBlockSeconds = 10.0;

  /// n > 0. The groups that these rows complete; valid until the next call.
  template <bool kSound>
  std::span<const GroupMean> push(const RigBlock& block, std::size_t n);

 private:
  bool begun_ = false;
  double block_start_s_ = 0.0;
  int filled_ = 0;
  double sum_theta_ = 0.0, sum_force_ = 0.0, sum_code_ = 0.0;
  std::vector<GroupMean> groups_;
};

}  // namespace forcegate::witness
