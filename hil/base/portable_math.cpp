#include "hil/base/portable_math.h"

#include <bit>
#include <cstdint>
#include <limits>

namespace forcegate::portable {
namespace {

constexpr double kTwoOverPi = 0.63661977236758134308;
// pi/2 in three parts of 33 bits (Cody and Waite), so that k * part is exact for |k| < 2^20.
constexpr double kPiHalf1 = 1.57079632673412561417e+00;
constexpr double kPiHalf2 = 6.07710050630396597660e-11;
constexpr double kPiHalf3 = 2.02226624879595063154e-21;

double sin_kernel(double r) {
  const double z = r * r;
  // Taylor to r^17: the remainder at pi/4 is 1e-18.
  double p = 2.81145725434552076e-15;
  p = p * z - 7.64716373181981648e-13;
  p = p * z + 1.60590438368216146e-10;
  p = p * z - 2.50521083854417188e-08;
  p = p * z + 2.75573192239858907e-06;
  p = p * z - 1.98412698412698413e-04;
  p = p * z + 8.33333333333333333e-03;
  p = p * z - 1.66666666666666667e-01;
  return r + r * (z * p);
}

double cos_kernel(double r) {
  const double z = r * r;
  double p = -1.56192069685862265e-16;
  p = p * z + 4.77947733238738530e-14;
  p = p * z - 1.14707455977297247e-11;
  p = p * z + 2.08767569878680990e-09;
  p = p * z - 2.75573192239858907e-07;
  p = p * z + 2.48015873015873016e-05;
  p = p * z - 1.38888888888888889e-03;
  p = p * z + 4.16666666666666667e-02;
  return 1.0 - (0.5 * z - z * z * p);
}

struct Reduced {
  double r;
  int quadrant;
};

Reduced reduce(double x) {
  const double scaled = x * kTwoOverPi;
  const auto k = static_cast<std::int64_t>(scaled + (scaled < 0 ? -0.5 : 0.5));
  const auto kd = static_cast<double>(k);
  return {((x - kd * kPiHalf1) - kd * kPiHalf2) - kd * kPiHalf3, static_cast<int>(k & 3)};
}

}  // namespace

double sin(double x) {
  const Reduced a = reduce(x);
  switch (a.quadrant) {
    case 0: return sin_kernel(a.r);
    case 1: return cos_kernel(a.r);
    case 2: return -sin_kernel(a.r);
    default: return -cos_kernel(a.r);
  }
}

double cos(double x) {
  const Reduced a = reduce(x);
  switch (a.quadrant) {
    case 0: return cos_kernel(a.r);
    case 1: return -sin_kernel(a.r);
    case 2: return -cos_kernel(a.r);
    default: return sin_kernel(a.r);
  }
}

double exp(double x) {
  if (x != x) return x;
  if (x > 709.78) return std::numeric_limits<double>::infinity();
  if (x < -708.0) return 0.0;
  constexpr double kInvLn2 = 1.44269504088896338700;
  constexpr double kLn2Hi = 6.93147180369123816490e-01;
  constexpr double kLn2Lo = 1.90821492927058770002e-10;
  const double scaled = x * kInvLn2;
  const auto k = static_cast<std::int64_t>(scaled + (scaled < 0 ? -0.5 : 0.5));
  const auto kd = static_cast<double>(k);
  const double r = (x - kd * kLn2Hi) - kd * kLn2Lo;
  double p = 1.0 / 6227020800.0;
  p = p * r + 1.0 / 479001600.0;
  p = p * r + 1.0 / 39916800.0;
  p = p * r + 1.0 / 3628800.0;
  p = p * r + 1.0 / 362880.0;
  p = p * r + 1.0 / 40320.0;
  p = p * r + 1.0 / 5040.0;
  p = p * r + 1.0 / 720.0;
  p = p * r + 1.0 / 120.0;
  p = p * r + 1.0 / 24.0;
  p = p * r + 1.0 / 6.0;
  p = p * r + 0.5;
  const double value = 1.0 + (r + r * r * p);
  return value * std::bit_cast<double>(static_cast<std::uint64_t>(k + 1023) << 52);
}

double log(double x) {
  if (!(x > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  if (x > std::numeric_limits<double>::max()) return x;
  int exponent = 0;
  if (x < std::numeric_limits<double>::min()) {
    x *= 18014398509481984.0;  // 2^54: bring denormals to normal numbers
    exponent -= 54;
  }
  const auto bits = std::bit_cast<std::uint64_t>(x);
  exponent += static_cast<int>(bits >> 52) - 1023;
  double m = std::bit_cast<double>((bits & 0x000FFFFFFFFFFFFFULL) | 0x3FF0000000000000ULL);
  if (m > 1.41421356237309504880) {
    m *= 0.5;
    ++exponent;
  }
  // log(m) = 2 atanh(s), s = (m-1)/(m+1), |s| < 0.1716.
  const double s = (m - 1.0) / (m + 1.0);
  const double z = s * s;
  double p = 2.0 / 23.0;
  p = p * z + 2.0 / 21.0;
  p = p * z + 2.0 / 19.0;
  p = p * z + 2.0 / 17.0;
  p = p * z + 2.0 / 15.0;
  p = p * z + 2.0 / 13.0;
  p = p * z + 2.0 / 11.0;
  p = p * z + 2.0 / 9.0;
  p = p * z + 2.0 / 7.0;
  p = p * z + 2.0 / 5.0;
  p = p * z + 2.0 / 3.0;
  const auto e = static_cast<double>(exponent);
  return e * 6.93147180369123816490e-01 + (2.0 * s + s * (z * p) + e * 1.90821492927058770002e-10);
}

double pow(double x, double y) { return exp(y * log(x)); }

}  // namespace forcegate::portable
