#include "rigs/emulated/hidden/numeric.h"

namespace forcegate::hidden {

double arc_cosine(double x) {
  if (x >= 1.0) return 0.0;
  if (x <= -1.0) return kPi;
  const double z = x < 0.0 ? -x : x;
  const double p =
      1.5707963050 +
      z * (-0.2145988016 +
           z * (0.0889789874 +
                z * (-0.0501743046 +
                     z * (0.0308918810 + z * (-0.0170881256 + z * (0.0066700901 + z * -0.0012624911))))));
  const double positive = std::sqrt(1.0 - z) * p;
  return x < 0.0 ? kPi - positive : positive;
}

double hyperbolic_tangent(double x) {
  if (x > 20.0) return 1.0;
  if (x < -20.0) return -1.0;
  const double e = portable::exp(2.0 * x);
  return (e - 1.0) / (e + 1.0);
}

double softplus(double x) {
  if (x > 35.0) return x;
  if (x < -35.0) return 0.0;
  return portable::log(1.0 + portable::exp(x));
}

double stretched(double t_s, double tau_s, double beta) {
  if (t_s <= 0.0) return 1.0;
  return portable::exp(-portable::pow(t_s / tau_s, beta));
}

}  // namespace forcegate::hidden
