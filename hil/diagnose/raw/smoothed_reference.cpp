#include "hil/diagnose/raw/smoothed_reference.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kStretch = 96;
constexpr double kFewest = 12.0;

// Products of x = F', y = F - F' and z = U over a stretch, less straight lines.
struct Stretch {
  double n = 0.0, xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0, taken = 0.0;
};

Stretch sums(std::span<const double> F, std::span<const double> smooth, std::span<const double> U, std::span<const std::uint8_t> bad) {
  Stretch out;
  const auto counts = [&](std::size_t i) { return bad[i] == 0 && std::isfinite(F[i]) && std::isfinite(smooth[i]) && std::isfinite(U[i]); };
  double n = 0.0, t = 0.0, tt = 0.0, x = 0.0, xt = 0.0, y = 0.0, yt = 0.0, z = 0.0, zt = 0.0;
  for (std::size_t i = 0; i < F.size(); ++i) {
    if (!counts(i)) continue;
    const double at = static_cast<double>(i);
    n += 1.0, t += at, tt += at * at;
    x += smooth[i], xt += smooth[i] * at;
    y += F[i] - smooth[i], yt += (F[i] - smooth[i]) * at;
    z += U[i], zt += U[i] * at;
  }
  if (n < kFewest) return out;
  const double variance = tt - t * t / n;
  const auto slope = [&](double sum, double sum_t) { return (sum_t - sum * t / n) / variance; };
  const double x1 = slope(x, xt), y1 = slope(y, yt), z1 = slope(z, zt);
  out.n = n;
  for (std::size_t i = 0; i < F.size(); ++i) {
    if (!counts(i)) continue;
    const double at = static_cast<double>(i) - t / n, taken = F[i] - smooth[i];
    const double dx = smooth[i] - x / n - x1 * at, dy = taken - y / n - y1 * at, dz = U[i] - z / n - z1 * at;
    out.xx += dx * dx, out.xy += dx * dy, out.xz += dx * dz, out.yy += dy * dy, out.yz += dy * dz, out.zz += dz * dz;
    out.taken += taken * taken;
  }
  return out;
}

}  // namespace

SharedPart shared_with_output(std::span<const double> F, std::span<const double> smooth, std::span<const double> U,
                              std::span<const std::uint8_t> bad) {
  std::vector<Stretch> stretches;
  Stretch all;
  for (std::size_t begin = 0; begin < F.size(); begin += kStretch) {
    const std::size_t n = std::min(kStretch, F.size() - begin);
    stretches.push_back(sums(F.subspan(begin, n), smooth.subspan(begin, n), U.subspan(begin, n), bad.subspan(begin, n)));
    const Stretch& s = stretches.back();
    all.n += s.n, all.xx += s.xx, all.xz += s.xz, all.yy += s.yy, all.taken += s.taken;
  }
  SharedPart out{0.0, std::numeric_limits<double>::infinity(), 0.0};
  if (!(all.n > 0.0) || !(all.xx > 0.0) || !(all.yy > 0.0)) return out;
  out.taken_N2 = all.taken / all.n;
  // where the force stands still its stretch has the gain of the record
  const double gain = all.xz / all.xx, noise_N2 = all.yy / all.n;
  double followed = 0.0, weight = 0.0, left = 0.0;
  for (const Stretch& s : stretches) {
    if (!(s.n > 0.0)) continue;
    const double g = (s.xz + gain * noise_N2 * s.n) / (s.xx + noise_N2 * s.n);
    // y and z less their parts along x
    const double yy = s.xx > 0.0 ? s.yy - s.xy * s.xy / s.xx : s.yy, yz = s.xx > 0.0 ? s.yz - s.xy * s.xz / s.xx : s.yz;
    followed += g * yz;
    weight += g * g * yy;
    left += s.xx > 0.0 ? s.zz - s.xz * s.xz / s.xx : s.zz;
  }
  if (!(weight > 0.0)) return out;
  out.share = followed / weight;
  out.standard_error = std::sqrt(std::max(0.0, left - out.share * followed) / all.n / weight);
  return out;
}

}  // namespace forcegate::diagnose
