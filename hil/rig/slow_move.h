#pragma once
// The wheel turned by hand, so to speak: slowly to one angle, with the force watched all the way.

#include <atomic>

#include "hil/rig/bench_session.h"

namespace forcegate {

constexpr double kNearTravel_rad = 0.2;  ///< a wheel that stands no further outside of its travel is led back; one further out is another angle than the wheel's
constexpr const char* kIntoTravel = "turn the wheel into its travel by hand; if it is there, mend sign and scale of 'position', or the travel in [geometry]";
/// How far an angle lies outside the travel; 0 inside.
double beyond_travel_rad(const RigGeometry& geometry, double theta_rad);

struct SlowMove {
  double angle_rad = 0.0;
  double speed_rad_per_s = 0.5;  ///< cut to the limits of the bench
  double tolerance_rad = 0.01;
  const std::atomic<bool>* stop = nullptr;  ///< ends the move when set
  double fine_rad = 0.0;                    ///< > 0: within the tolerance it goes on for a second at most, to come as near as this
};

struct SlowMoveEnd {
  double from_rad = 0.0, to_rad = 0.0;
  double force_N = 0.0;  ///< last reading of the reference
};

/// Arms the bench, starts the reference, moves, stops the motor; the reference goes on. On every error the motor is stopped before it is told, and
/// the error says whether the drive has confirmed that: safety (force beyond the bench's limit in either direction, a reading that is not valid, a
/// reference that is silent for 0.25 s), device (drive fault, wheel that does not get there, stands outside its travel or turns the wrong way), usage (angle outside the travel), cancelled.
Result<SlowMoveEnd> move_slowly(BenchSession& session, const SlowMove& move);

}  // namespace forcegate
