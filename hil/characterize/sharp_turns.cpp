#include "hil/characterize/sharp_turns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "hil/base/quantile.h"

namespace forcegate::characterize {
namespace {

constexpr double kMeanIsGood = 200.0, kFew = 16.0;  // samples in a cycle

// y = p0 + p1 x + p2 x^2 over x in steps of the sampling, least squares.
struct Parabola {
  double p0 = 0.0, p1 = 0.0, p2 = 0.0;
  double at(double x) const { return p0 + x * (p1 + x * p2); }
  double vertex() const { return -p1 / (2.0 * p2); }
};

Parabola parabola(std::span<const float> y, std::size_t middle, int half) {
  double n = 0.0, s2 = 0.0, s4 = 0.0, y0 = 0.0, y1 = 0.0, y2 = 0.0;
  for (int k = -half; k <= half; ++k) {
    const double x = k, v = static_cast<double>(y[static_cast<std::size_t>(static_cast<int>(middle) + k)]);
    n += 1.0;
    s2 += x * x;
    s4 += x * x * x * x;
    y0 += v;
    y1 += x * v;
    y2 += x * x * v;
  }
  const double det = n * s4 - s2 * s2;
  return {(y0 * s4 - y2 * s2) / det, y1 / s2, (n * y2 - s2 * y0) / det};
}

// Samples around it at one rate, none missing.
bool is_even(std::span<const double> t_s, std::size_t middle, std::size_t half) {
  constexpr double kEven = 0.2;
  const double step_s = t_s[middle + 1] - t_s[middle];
  for (std::size_t i = middle - half; i < middle + half; ++i)
    if (std::abs(t_s[i + 1] - t_s[i] - step_s) > kEven * step_s) return false;
  return true;
}

void sharpen(std::span<const double> t_s, std::span<const float> force_N, std::span<const float> sensor_V, std::size_t half, bool are_maxima, Turns& turns) {
  for (std::size_t k = 0; k < turns.size(); ++k) {
    const auto next = static_cast<std::size_t>(std::lower_bound(t_s.begin(), t_s.end(), turns.t_s[k]) - t_s.begin());
    const std::size_t i = next > 0 && (next == t_s.size() || turns.t_s[k] - t_s[next - 1] < t_s[next] - turns.t_s[k]) ? next - 1 : next;
    if (i < half || i + half >= t_s.size() || !is_even(t_s, i, half)) continue;
    const Parabola force = parabola(force_N, i, static_cast<int>(half));
    if (!(are_maxima ? force.p2 < 0.0 : force.p2 > 0.0) || std::abs(force.vertex()) > 1.0) continue;
    turns.t_s[k] = t_s[i] + force.vertex() * (t_s[i + 1] - t_s[i]);
    turns.ati_N[k] = turns.setpoint_N[k] = force.at(force.vertex());
    turns.sensor_V[k] = parabola(sensor_V, i, static_cast<int>(half)).at(force.vertex());
  }
}

}  // namespace

double samples_per_cycle(std::span<const double> t_s, const Extrema& e) {
  if (e.maxima.size() < 2 || t_s.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  const auto median_step = [](std::span<const double> t) {
    std::vector<double> step;
    for (std::size_t i = 1; i < t.size(); ++i) step.push_back(t[i] - t[i - 1]);
    return median(std::move(step));
  };
  return median_step(e.maxima.t_s) / median_step(t_s);
}

void sharpen_turns(std::span<const double> t_s, std::span<const float> force_N, std::span<const float> sensor_V, Extrema& e) {
  const double samples = samples_per_cycle(t_s, e);
  if (!(samples < kMeanIsGood)) return;
  const std::size_t half = samples < kFew ? 1 : 2;
  sharpen(t_s, force_N, sensor_V, half, true, e.maxima);
  sharpen(t_s, force_N, sensor_V, half, false, e.minima);
}

}  // namespace forcegate::characterize
