#include "hil/rig/slow_move.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/base/text.h"
#include "hil/rig/velocity_limits.h"

namespace forcegate {
namespace {

constexpr double kPeriod_s = 0.01, kSilence_s = 0.25;

Result<SlowMoveEnd> move(BenchSession& s, const SlowMove& m) {
  const RigGeometry& g = s.bench().geometry;
  const BenchLimits& limits = s.bench().limits;
  if (m.angle_rad < g.theta_min_rad || m.angle_rad > g.theta_max_rad)
    return fail(
        ErrorCode::usage, fmt::format("{:.3f} rad is outside the travel", m.angle_rad),
        s.bench().path.string(),
        fmt::format("give an angle from {} to {} rad", shortest(g.theta_min_rad), shortest(g.theta_max_rad)));
  FORCEGATE_CHECK_OK(s.arm());
  FORCEGATE_TRY(MotorState state, s.motor().read());
  SlowMoveEnd end{state.theta_rad, state.theta_rad, std::numeric_limits<double>::quiet_NaN()};
  FORCEGATE_CHECK_OK(s.reference().start());
  BenchWorld& world = s.world();
  const double steepest_N_per_rad = g.spring_N_per_mm * g.eccentricity_mm,
               slowest_rad_per_s = std::min({m.speed_rad_per_s, limits.velocity_max_rad_per_s, limits.force_rate_max_N_per_s / steepest_N_per_rad});
  const double until_s = world.now_s() + 2.0 * std::fabs(m.angle_rad - state.theta_rad) / slowest_rad_per_s + 2.0;
  double seen_s = world.now_s();
  std::vector<ReferenceReading> seen;
  // a wheel that stands there already is not left before the reference has said something
  while (std::fabs(state.theta_rad - m.angle_rad) > m.tolerance_rad || std::isnan(end.force_N)) {
    if (m.stop != nullptr && m.stop->load())
      return fail(ErrorCode::cancelled, "interrupted", s.bench().path.string());
    if (world.now_s() > until_s)
      return fail(ErrorCode::device,
                  fmt::format("the wheel does not reach {:.2f} rad: it stands at {:.2f} rad", m.angle_rad,
                              state.theta_rad),
                  "motor", "check coupling, scale of 'position' and that the wheel is free");
    const double way = m.angle_rad - state.theta_rad;
    const double wanted_rad_per_s = std::clamp(4.0 * way, -m.speed_rad_per_s, m.speed_rad_per_s);
    FORCEGATE_CHECK_OK(s.motor().command_velocity(
        cut_to_limits(wanted_rad_per_s, state.theta_rad, g, limits.velocity_max_rad_per_s, limits.force_rate_max_N_per_s)));
    FORCEGATE_CHECK_OK(world.advance_to(world.now_s() + kPeriod_s));
    FORCEGATE_CHECK_OK(s.beat());
    FORCEGATE_TRY(state, s.motor().read());
    if (state.fault)
      return fail(ErrorCode::device, fmt::format("the drive reports fault {:#x}", state.fault_code), "motor",
                  "find its cause in the drive's manual, then forcegate bench reset with the bench file");
    seen.clear();
    FORCEGATE_CHECK_OK(s.reference().poll(seen));
    for (const ReferenceReading& r : seen) {
      if ((r.status & kRigReferenceSaturated) != 0)
        return fail(ErrorCode::safety, "the reference is overloaded", "reference", "unload the sensor and look for what blocks the wheel");
      end.force_N = static_cast<double>(r.force_N);
      if (r.status != 0 || std::isnan(end.force_N))
        return fail(ErrorCode::safety, "the reference gives no valid reading", "reference", "check its cable and what its maker says of its error codes");
      if (!(std::fabs(end.force_N) <= limits.force_max_N))
        return fail(ErrorCode::safety, fmt::format("the force is {:.2f} N", end.force_N), "reference", "unload the sensor and look for what blocks the wheel");
      seen_s = world.now_s();
    }
    if (world.now_s() - seen_s > kSilence_s)
      return fail(ErrorCode::safety, "the reference is silent", "reference",
                  "check its cable");
  }
  FORCEGATE_CHECK_OK(s.motor().stop());
  end.to_rad = state.theta_rad;
  return end;
}

}  // namespace

Result<SlowMoveEnd> move_slowly(BenchSession& session, const SlowMove& m) {
  auto done = move(session, m);
  if (done) return done;
  Error error = done.error();
  const bool moved = session.armed();
  if (!session.make_safe()) {
    error.text += "; the drive confirms no stop, the motor may turn";
    error.hint = fmt::format("cut the power of the drive unless its own timeout of {} s stops it", shortest(session.motor().drive_timeout_s()));
  } else if (moved) {
    error.text += ": the motor is stopped";
  }
  return Unexpected(std::move(error));
}

}  // namespace forcegate
