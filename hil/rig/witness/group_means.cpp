#include "hil/rig/witness/group_means.h"

#include "hil/rig/witness/rows.h"

namespace forcegate::witness {

template <bool kSound>
std::span<const GroupMean> GroupMeans::push(const RigBlock& block, std::size_t n) {
  const float *force_N = block.force_ref_N.data(), *theta = block.theta_rad.data();
  const std::uint16_t *code = block.adc.data(), *status = block.status.data();
  if (!begun_) begun_ = true, block_start_s_ = block.t_s[0];
  groups_.clear();
  int filled = filled_;
  double sum_theta = sum_theta_, sum_force = sum_force_, sum_code = sum_code_;
  for (std::size_t i = 0; i < n; ++i) {
    if (!kSound && no_reference(force_N[i], status[i])) continue;
    sum_theta += theta[i];
    sum_force += force_N[i];
    sum_code += code[i];
    if (++filled < kGroup) continue;
    const bool begins = block.t_s[i] - block_start_s_ >= kBlockSeconds;
    if (begins) block_start_s_ = block.t_s[i];
    groups_.push_back({block.t_s[i], sum_theta / kGroup, sum_force / kGroup, sum_code / kGroup, begins});
    filled = 0;
    sum_theta = sum_force = sum_code = 0.0;
  }
  filled_ = filled;
  sum_theta_ = sum_theta, sum_force_ = sum_force, sum_code_ = sum_code;
  return groups_;
}
template std::span<const GroupMean> GroupMeans::push<true>(const RigBlock&, std::size_t);
template std::span<const GroupMean> GroupMeans::push<false>(const RigBlock&, std::size_t);

}  // namespace forcegate::witness
