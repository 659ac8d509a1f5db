#pragma once
// Wheel angle of a force: F = k (preload + e (1 - cos theta)), 0 <= theta <= pi (Lebosse 2011, II-B).

#include "hil/interface/rig.h"

namespace forcegate {

/// Angle of a force, rad, cut to the travel; theta_min when the wheel has no eccentricity.
double wheel_angle_rad(const RigGeometry& geometry, double force_N);

/// Largest dF/dtheta of the wheel, N/rad (at a quarter turn).
inline double wheel_slope_max_N_per_rad(const RigGeometry& g) {
  return g.spring_N_per_mm * g.eccentricity_mm;
}

}  // namespace forcegate
