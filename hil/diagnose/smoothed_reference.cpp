#include "hil/diagnose/smoothed_reference.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kStretch = 96;

// Sums of products of x, y, z less a straight line over the stretch.
struct Sums {
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0, n = 0.0;
  void operator+=(const Sums& o) { xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz, n += o.n; }
};

}  // namespace

SharedPart shared_with_output(std::span<const double> F, std::span<const double> smooth, std::span<const double> U,
                              std::span<const std::uint8_t> bad) {
  constexpr double kFewest = 12.0;
  Sums all;
  for (std::size_t begin = 0; begin < F.size(); begin += kStretch) {
    const std::size_t end = std::min(F.size(), begin + kStretch);
    const auto counts = [&](std::size_t i) { return bad[i] == 0 && std::isfinite(F[i]) && std::isfinite(smooth[i]) && std::isfinite(U[i]); };
    double n = 0.0, t = 0.0, tt = 0.0, s = 0.0, st = 0.0, d = 0.0, dt = 0.0, u = 0.0, ut = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      if (!counts(i)) continue;
      const double at = static_cast<double>(i - begin);
      n += 1.0, t += at, tt += at * at;
      s += smooth[i], st += smooth[i] * at;
      d += F[i] - smooth[i], dt += (F[i] - smooth[i]) * at;
      u += U[i], ut += U[i] * at;
    }
    if (n < kFewest) continue;
    const double variance = tt - t * t / n;
    const auto slope = [&](double sum, double sum_t) { return (sum_t - sum * t / n) / variance; };
    const double s1 = slope(s, st), d1 = slope(d, dt), u1 = slope(u, ut);
    for (std::size_t i = begin; i < end; ++i) {
      if (!counts(i)) continue;
      const double at = static_cast<double>(i - begin) - t / n;
      const double x = smooth[i] - s / n - s1 * at, y = F[i] - smooth[i] - d / n - d1 * at, z = U[i] - u / n - u1 * at;
      all += {x * x, x * y, x * z, y * y, y * z, z * z, 1.0};
    }
  }
  SharedPart out{0.0, std::numeric_limits<double>::infinity()};
  const double determinant = all.xx * all.yy - all.xy * all.xy;
  if (!(determinant > 0.0)) return out;
  const double g = (all.xz * all.yy - all.yz * all.xy) / determinant, h = (all.yz * all.xx - all.xz * all.xy) / determinant;
  if (g == 0.0) return out;
  const double left = std::max(0.0, all.zz - g * all.xz - h * all.yz);
  out.share = h / g;
  out.standard_error = std::sqrt(left / all.n * all.xx / determinant) / std::abs(g);
  return out;
}

}  // namespace forcegate::diagnose
