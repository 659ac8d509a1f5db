#include "hil/rig/safety_gate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/rig/velocity_limits.h"

namespace forcegate {

namespace {

constexpr double kLongestBlind_s = 0.25;  // 250 samples are more than that on a slow board

}  // namespace

std::string_view to_string(StopReason reason) {
  switch (reason) {
    case StopReason::none: return "none";
    case StopReason::force_limit: return "force above the limit";
    case StopReason::reference_lost: return "no valid ATI reading";
    case StopReason::motor_fault: return "motor fault";
    case StopReason::bad_command: return "velocity command is not a number";
    case StopReason::rig_stopped: return "the rig stopped itself";
  }
  return "none";
}

SafetyGate::SafetyGate(Rig& rig, const SafetyLimits& limits) : rig_(rig), limits_(limits) {}

SafetyGate::~SafetyGate() { rig_.park(); }

Result<void> SafetyGate::begin(const RigRecordRequest& request) {
  report_ = {};
  force_max_N_ = limits_.force_max_N;
  lost_run_ = 0;
  last_t_s_ = 0.0;
  FORCEGATE_CHECK_OK(rig_.begin(request));
  const RigInfo info = rig_.info();
  geometry_ = info.geometry;
  can_move_ = info.can_move;
  rate_max_N_per_s_ = info.force_rate_max_N_per_s;
  lost_max_ = std::min(limits_.reference_lost_samples, std::max(1, static_cast<int>(std::ceil(kLongestBlind_s * info.rate_Hz))));
  if (can_move_ && info.force_max_N > 0.0) force_max_N_ = std::min(limits_.force_max_N, info.force_max_N);
  return {};
}

void SafetyGate::stop(StopReason reason, double t_s, double force_N) {
  if (report_.stopped()) return;
  report_.reason = reason;
  report_.t_s = t_s;
  report_.force_N = force_N;
  rig_.park();
}

Result<double> SafetyGate::command(double velocity_rad_per_s) {
  if (report_.stopped() || !can_move_) return 0.0;
  if (!std::isfinite(velocity_rad_per_s)) {
    stop(StopReason::bad_command, last_t_s_, rig_.force_ref_N());
    return 0.0;
  }
  const double theta = rig_.theta_rad();
  double velocity = cut_to_limits(velocity_rad_per_s, theta, geometry_, geometry_.velocity_max_rad_per_s, rate_max_N_per_s_);
  if (const double of_plan = limits_.velocity_max_rad_per_s; of_plan > 0.0) velocity = std::clamp(velocity, -of_plan, of_plan);
  if (theta >= geometry_.theta_max_rad) velocity = std::min(velocity, 0.0);
  if (theta <= geometry_.theta_min_rad) velocity = std::max(velocity, 0.0);
  if (velocity != velocity_rad_per_s) ++report_.clipped_commands;
  FORCEGATE_CHECK_OK(rig_.command_velocity(velocity));
  return velocity;
}

// No status bit and no force above the limit (NaN is neither below nor at it): nothing to count, nothing to stop.
bool SafetyGate::all_sound(const RigBlock& rows, std::size_t at, std::size_t n) const {
  const std::uint16_t* const status = rows.status.data() + at;
  const float* const force_N = rows.force_ref_N.data() + at;
  const double force_max_N = std::min<double>(force_max_N_, std::numeric_limits<float>::max());
  unsigned strange = 0;
  for (std::size_t i = 0; i < n; ++i)
    strange |= status[i] | static_cast<unsigned>(!(std::fabs(force_N[i]) <= force_max_N));
  return strange == 0;
}

Result<std::size_t> SafetyGate::run(std::size_t n, RigBlock& out, std::size_t at) {
  if (report_.stopped()) return std::size_t{0};
  auto ran = rig_.run(n, out, at);
  if (!ran) {
    rig_.park();
    return ran;
  }
  const std::size_t got = *ran;
  if (got > 0 && all_sound(out, at, got)) {
    last_t_s_ = out.t_s[at + got - 1];
    if (can_move_) lost_run_ = 0;
    return got;
  }
  constexpr std::uint16_t kReferenceBad = kRigReferenceSaturated | kRigReferenceFault;
  for (std::size_t i = at; i < at + got; ++i) {
    const std::uint16_t status = out.status[i];
    const float force_N = out.force_ref_N[i];
    last_t_s_ = out.t_s[i];
    if (status & kRigTravelStop && report_.travel_samples++ == 0) report_.travel_first_s = out.t_s[i];
    if (!can_move_) continue;  // a recording cannot be stopped
    StopReason reason = StopReason::none;
    if (status & kRigSafetyStop) reason = StopReason::rig_stopped;
    if (status & kRigMotorFault) reason = StopReason::motor_fault;
    if ((status & kReferenceBad) || !std::isfinite(force_N)) {
      if (++lost_run_ >= lost_max_) reason = StopReason::reference_lost;
    } else {
      lost_run_ = 0;
      if (std::fabs(force_N) > force_max_N_) reason = StopReason::force_limit;
    }
    if (reason == StopReason::none) continue;
    stop(reason, out.t_s[i], force_N);
    for (std::size_t k = i; k < at + got; ++k) out.status[k] |= kRigSafetyStop;
    break;
  }
  return got;
}

}  // namespace forcegate
