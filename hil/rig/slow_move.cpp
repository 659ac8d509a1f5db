#include "hil/rig/slow_move.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/base/text.h"
#include "hil/rig/force_watch.h"
#include "hil/rig/velocity_limits.h"

namespace forcegate {
namespace {

// The angle is all that tells where the wheel is: one that is read with the wrong sign or scale would be followed to the stop.
class WayWatch {
 public:
  WayWatch(const RigGeometry& g, double from_rad, double to_rad)
      : g_(g), from_rad_(from_rad), to_rad_(to_rad), outside_rad_(beyond_travel_rad(g, from_rad)) {}

  Result<void> begin() const {
    if (outside_rad_ <= kNearTravel_rad) return {};
    return fail(ErrorCode::device, fmt::format("the wheel stands at {:.3f} rad, outside its travel of {} to {:.3f} rad", from_rad_, shortest(g_.theta_min_rad), g_.theta_max_rad),
                "motor", kIntoTravel);
  }
  Result<void> look(double theta_rad) const {
    constexpr double kSlack_rad = 0.1;
    constexpr const char* kHelp = "check sign and scale of 'position' and of 'velocity_set', coupling and wiring of the motor";
    if (beyond_travel_rad(g_, theta_rad) > outside_rad_ + kSlack_rad)
      return fail(ErrorCode::device, fmt::format("the wheel has left its travel on the way from {:.2f} to {:.2f} rad: it stands at {:.2f} rad", from_rad_, to_rad_, theta_rad), "motor", kHelp);
    if (std::fabs(theta_rad - to_rad_) > std::fabs(from_rad_ - to_rad_) + kSlack_rad)
      return fail(ErrorCode::device, fmt::format("the wheel turns away from {:.2f} rad: it stood at {:.2f} rad and stands at {:.2f} rad", to_rad_, from_rad_, theta_rad), "motor", kHelp);
    return {};
  }

 private:
  const RigGeometry& g_;
  double from_rad_, to_rad_, outside_rad_;
};

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
  const WayWatch way_watch(g, state.theta_rad, m.angle_rad);
  FORCEGATE_CHECK_OK(way_watch.begin());
  SlowMoveEnd end{state.theta_rad, state.theta_rad, std::numeric_limits<double>::quiet_NaN()};
  FORCEGATE_CHECK_OK(s.reference().start());
  const double steepest_N_per_rad = g.spring_N_per_mm * g.eccentricity_mm,
               slowest_rad_per_s = std::min({m.speed_rad_per_s, limits.velocity_max_rad_per_s, limits.force_rate_max_N_per_s / steepest_N_per_rad});
  const double until_s = s.world().now_s() + 2.0 * std::fabs(m.angle_rad - state.theta_rad) / slowest_rad_per_s + 2.0;
  ForceWatch watch(s);
  // a wheel that stands there already is not left before the reference has said something
  constexpr double kNearer_s = 1.0;  // a drive turns no slower than it can, or reads its angle in steps: what it does not reach is no fault
  double near_until_s = std::numeric_limits<double>::infinity();
  const auto there = [&] {
    const double off_rad = std::fabs(state.theta_rad - m.angle_rad);
    if (off_rad > m.tolerance_rad || std::isnan(watch.force_N())) return false;
    near_until_s = std::min(near_until_s, s.world().now_s() + kNearer_s);
    return !(m.fine_rad > 0.0) || off_rad <= m.fine_rad || s.world().now_s() >= near_until_s;
  };
  while (!there()) {
    if (m.stop != nullptr && m.stop->load())
      return fail(ErrorCode::cancelled, "interrupted", s.bench().path.string());
    if (s.world().now_s() > until_s && std::isinf(near_until_s))
      return fail(ErrorCode::device,
                  fmt::format("the wheel does not reach {:.2f} rad: it stands at {:.2f} rad", m.angle_rad,
                              state.theta_rad),
                  "motor", "check coupling, scale of 'position' and that the wheel is free");
    const double way = m.angle_rad - state.theta_rad;
    const double wanted_rad_per_s = std::clamp(4.0 * way, -m.speed_rad_per_s, m.speed_rad_per_s);
    FORCEGATE_CHECK_OK(s.motor().command_velocity(
        cut_to_limits(wanted_rad_per_s, state.theta_rad, g, limits.velocity_max_rad_per_s, limits.force_rate_max_N_per_s)));
    FORCEGATE_TRY(state, watch.look());
    FORCEGATE_CHECK_OK(way_watch.look(state.theta_rad));
  }
  FORCEGATE_CHECK_OK(s.motor().stop());
  end.to_rad = state.theta_rad;
  end.force_N = watch.force_N();
  return end;
}

}  // namespace

double beyond_travel_rad(const RigGeometry& g, double theta_rad) { return std::max({g.theta_min_rad - theta_rad, theta_rad - g.theta_max_rad, 0.0}); }

Result<SlowMoveEnd> move_slowly(BenchSession& session, const SlowMove& m) {
  auto done = move(session, m);
  if (done) return done;
  return Unexpected(made_safe(session, done.error()));
}

}  // namespace forcegate
