#include "hil/rig/rig_witness.h"

#include <cmath>
#include <cstdint>
#include <span>

namespace forcegate {
namespace {

bool all_sound(const RigBlock& block, std::size_t n) {
  const float *force_N = block.force_ref_N.data(), *theta = block.theta_rad.data();
  const std::uint16_t* status = block.status.data();
  constexpr float kLargest = std::numeric_limits<float>::max();
  unsigned strange = 0;
  for (std::size_t i = 0; i < n; ++i)
    strange |= status[i] | static_cast<unsigned>(!(std::fabs(force_N[i]) <= kLargest)) |
               static_cast<unsigned>(!(std::fabs(theta[i]) <= kLargest));
  return strange == 0;
}

}  // namespace

void RigWitness::begin(const RigInfo& info) {
  *this = RigWitness();
  const double period_s = 1.0 / info.rate_Hz;
  wheel_ = info.geometry.eccentricity_mm > 0.0;
  time_ = witness::TimeWatch(period_s);
  changes_ = witness::ChangeWatch(info);
  spring_ = witness::SpringWatch(info);
  sensor_ = witness::SensorWatch(info);
  drive_ = witness::DriveWatch(period_s);
}

template <bool kSound>
void RigWitness::push_rows(const RigBlock& block, std::size_t n, const float* commanded) {
  noise_.push<kSound>(block, n);
  changes_.push<kSound>(block, n);
  const std::span<const witness::GroupMean> groups = groups_.push<kSound>(block, n);
  spring_.push(groups);
  sensor_.push(groups);
  if (wheel_ && commanded != nullptr) drive_.push<kSound>(block, n, commanded);
}

void RigWitness::push(const RigBlock& block, std::size_t n, const float* commanded) {
  if (n == 0) return;
  time_.push(block.t_s.data(), n);
  codes_.push(block.adc.data(), block.status.data(), block.force_ref_N.data(), n);
  if (all_sound(block, n))
    push_rows<true>(block, n, commanded);
  else
    push_rows<false>(block, n, commanded);
}

RigObservation RigWitness::finish() const {
  RigObservation o;
  o.zero_start_N = zero_start_N_;
  o.zero_end_N = zero_end_N_;
  time_.finish(o);
  codes_.finish(o);
  noise_.finish(o);
  changes_.finish(o.adc_max, o);
  spring_.finish(o);
  sensor_.finish(o);
  drive_.finish(o);
  // Angles that are too rare for the spring tell nothing of the drive either.
  if (o.spring_samples < witness::SpringWatch::kLeastSamples) o.following_rad = std::numeric_limits<double>::quiet_NaN();
  return o;
}

}  // namespace forcegate
