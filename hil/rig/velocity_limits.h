#pragma once
// What the limits of a bench leave of a velocity of its wheel.

#include <algorithm>
#include <cmath>

#include "hil/base/portable_math.h"
#include "hil/interface/rig.h"

namespace forcegate {

/// `velocity_rad_per_s` cut to the largest velocity and, where the force follows the angle by k e sin(theta), to the fastest change of force;
/// 0: no such limit.
inline double cut_to_limits(double velocity_rad_per_s, double theta_rad, const RigGeometry& g, double velocity_max_rad_per_s,
                            double force_rate_max_N_per_s) {
  double out = velocity_rad_per_s;
  if (velocity_max_rad_per_s > 0.0) out = std::clamp(out, -velocity_max_rad_per_s, velocity_max_rad_per_s);
  if (!(force_rate_max_N_per_s > 0.0)) return out;
  const double slope = std::fabs(g.spring_N_per_mm * g.eccentricity_mm * portable::sin(theta_rad));
  return slope * std::fabs(out) > force_rate_max_N_per_s ? std::copysign(force_rate_max_N_per_s / slope, out) : out;
}

}  // namespace forcegate
