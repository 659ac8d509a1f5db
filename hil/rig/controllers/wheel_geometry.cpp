#include "hil/rig/controllers/wheel_geometry.h"

#include <algorithm>
#include <numbers>

#include "hil/base/portable_math.h"

namespace forcegate {
namespace {

// acos by a polynomial start (Abramowitz and Stegun 4.4.45, error 7e-5) and one Newton step on the cosine.
double portable_acos(double c) {
  c = std::clamp(c, -1.0, 1.0);
  const double a = c < 0.0 ? -c : c;
  double x = __builtin_sqrt(1.0 - a) * (1.5707288 + a * (-0.2121144 + a * (0.0742610 - a * 0.0187293)));
  if (const double s = portable::sin(x); s > 1e-3) x += (portable::cos(x) - a) / s;
  return c < 0.0 ? std::numbers::pi - x : x;
}

}  // namespace

double wheel_angle_rad(const RigGeometry& g, double force_N) {
  const double slope = wheel_slope_max_N_per_rad(g);
  if (!(slope > 0.0)) return g.theta_min_rad;
  const double c = 1.0 - (force_N - g.spring_N_per_mm * g.preload_mm) / slope;
  return std::clamp(portable_acos(c), g.theta_min_rad, g.theta_max_rad);
}

}  // namespace forcegate
