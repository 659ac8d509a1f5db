#pragma once

#include "hil/base/portable_math.h"

namespace forcegate::emulated {

/// Eccentric wheel that pushes the trolley: travel x = e (1 - cos theta), e from 0 to 12 mm
/// (Lebosse 2011, II-B); theta = 0 is the position of least force.
class EccentricWheel {
 public:
  void set_eccentricity_mm(double e) { e_mm_ = e; }
  double eccentricity_mm() const { return e_mm_; }

  /// 0 <= theta <= pi; absolute error of the cosine below 3e-11.
  double travel_mm(double theta_rad) const { return e_mm_ * (1.0 + sin_quarter(theta_rad - kHalfPi)); }

  /// Angle in [0, pi] for a travel in [0, 2 e]; the nearest end outside of it.
  double angle_rad(double travel_mm) const {
    if (e_mm_ <= 0.0 || travel_mm <= 0.0) return 0.0;
    if (travel_mm >= 2.0 * e_mm_) return 2.0 * kHalfPi;
    double low = 0.0, high = 2.0 * kHalfPi;
    for (int i = 0; i < 52; ++i) {
      const double middle = 0.5 * (low + high);
      (travel_mm > e_mm_ * (1.0 - portable::cos(middle)) ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }

 private:
  static constexpr double kHalfPi = 1.57079632679489661923;

  static double sin_quarter(double r) {  // Taylor to r^15 on [-pi/2, pi/2]
    const double z = r * r;
    double p = -7.64716373181981648e-13;
    p = p * z + 1.60590438368216146e-10;
    p = p * z - 2.50521083854417188e-08;
    p = p * z + 2.75573192239858907e-06;
    p = p * z - 1.98412698412698413e-04;
    p = p * z + 8.33333333333333333e-03;
    p = p * z - 1.66666666666666667e-01;
    return r + r * (z * p);
  }

  double e_mm_ = 10.0;
};

}  // namespace forcegate::emulated
