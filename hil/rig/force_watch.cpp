#include "hil/rig/force_watch.h"

#include <fmt/format.h>

#include <cmath>

#include "hil/base/text.h"

namespace forcegate {
namespace {

constexpr double kPeriod_s = 0.01, kSilence_s = 0.25;

}  // namespace

Result<void> ForceWatch::hear(const ReferenceReading& r) {
  if ((r.status & kRigReferenceSaturated) != 0)
    return fail(ErrorCode::safety, "the reference is overloaded", "reference", "unload the sensor and look for what blocks the wheel");
  force_N_ = static_cast<double>(r.force_N);
  if (r.status != 0 || std::isnan(force_N_))
    return fail(ErrorCode::safety, "the reference gives no valid reading", "reference", "check its cable and what its maker says of its error codes");
  if (!(std::fabs(force_N_) <= session_.bench().limits.force_max_N))
    return fail(ErrorCode::safety, fmt::format("the force is {:.2f} N", force_N_), "reference", "unload the sensor and look for what blocks the wheel");
  return {};
}

Result<MotorState> ForceWatch::look() {
  BenchWorld& world = session_.world();
  FORCEGATE_CHECK_OK(world.advance_to(world.now_s() + kPeriod_s));
  FORCEGATE_CHECK_OK(session_.beat());
  FORCEGATE_TRY(MotorState state, session_.motor().read());
  if (state.fault)
    return fail(ErrorCode::device, fmt::format("the drive reports fault {:#x}", state.fault_code), "motor",
                "find its cause in the drive's manual, then forcegate bench reset with the bench file");
  readings_.clear();
  FORCEGATE_CHECK_OK(session_.reference().poll(readings_));
  for (const ReferenceReading& r : readings_) FORCEGATE_CHECK_OK(hear(r));
  if (!readings_.empty()) heard_s_ = world.now_s();
  if (world.now_s() - heard_s_ > kSilence_s) return fail(ErrorCode::safety, "the reference is silent", "reference", "check its cable");
  return state;
}

Error made_safe(BenchSession& session, Error error) {
  const bool moved = session.armed();
  if (!session.make_safe()) {
    error.text += "; the drive confirms no stop, the motor may turn";
    error.hint = fmt::format("cut the power of the drive unless its own timeout of {} s stops it", shortest(session.motor().drive_timeout_s()));
  } else if (moved) {
    error.text += ": the motor is stopped";
  }
  return error;
}

}  // namespace forcegate
