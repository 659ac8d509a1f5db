#include "hil/diagnose/mains_line.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/model/rows.h"

namespace forcegate::diagnose {

namespace {

// Power at frequency_Hz of x with a Hann window: (amplitude / 2)^2 for a line in the middle of the bin.
double power_at(const double* x, std::size_t n, double rate_Hz, double frequency_Hz) {
  const double step = 2.0 * std::numbers::pi * frequency_Hz / rate_Hz;
  const double c = std::cos(step), s = std::sin(step);
  const double wc = std::cos(2.0 * std::numbers::pi / static_cast<double>(n)),
               ws = std::sin(2.0 * std::numbers::pi / static_cast<double>(n));
  double re = 0.0, im = 0.0, pc = 1.0, ps = 0.0, hc = 1.0, hs = 0.0, total = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double w = 0.5 - 0.5 * hc;
    re += w * x[i] * pc;
    im += w * x[i] * ps;
    total += w;
    const double p = pc * c - ps * s, h = hc * wc - hs * ws;
    ps = pc * s + ps * c;
    hs = hc * ws + hs * wc;
    pc = p;
    hc = h;
  }
  return (re * re + im * im) / (total * total);
}

double alias(double frequency_Hz, double rate_Hz) {
  const double folded = std::fmod(frequency_Hz, rate_Hz);
  return std::min(folded, rate_Hz - folded);
}

}  // namespace

MainsLine find_mains_line(const std::vector<double>& t, const std::vector<double>& F,
                          const std::vector<double>& U, double gain) {
  MainsLine best;
  const std::size_t n = t.size();
  if (n < 512 || !(t[n - 1] > t[0])) return best;
  const double rate = static_cast<double>(n - 1) / (t[n - 1] - t[0]);
  const auto length = static_cast<std::size_t>(4.0 * rate);
  if (length < 128 || n < 2 * length) return best;
  const std::size_t segments = std::min<std::size_t>(12, n / length);
  // second differences whiten the smooth force before the window sees it
  std::vector<double> e(length), f(length);
  for (double mains : {50.0, 60.0, 150.0, 180.0}) {
    const double line = alias(mains, rate);
    if (line < 4.0 || line > 0.495 * rate + 1e-9) continue;
    std::vector<double> ratio, amplitude;
    for (std::size_t k = 0; k < segments; ++k) {
      const std::size_t from = k * (n - length) / std::max<std::size_t>(1, segments - 1);
      bool whole = from >= 1 && from + length + 1 <= n;
      if (!whole) continue;
      for (std::size_t i = 0; i < length && whole; ++i) {
        const std::size_t at = from + i;
        e[i] = U[at] - gain * F[at];
        f[i] = gain * F[at];
        whole = std::isfinite(e[i]);
      }
      if (!whole) continue;
      double at_line = 0.0, force = 0.0;
      for (double shift : {-0.25, 0.0, 0.25}) {
        at_line = std::max(at_line, power_at(e.data(), length, rate, line + shift));
        force = std::max(force, power_at(f.data(), length, rate, line + shift));
      }
      std::vector<double> beside;
      for (double shift : {-3.0, -2.25, -1.5, 1.5, 2.25, 3.0})
        if (line + shift > 1.0 && line + shift < 0.5 * rate)
          beside.push_back(power_at(e.data(), length, rate, line + shift));
      if (beside.size() < 2) continue;
      ratio.push_back(at_line / (quantile(beside, 0.5) + 3.0 * force + 1e-18));
      amplitude.push_back(2.0 * std::sqrt(at_line));
    }
    if (ratio.size() < 2) continue;
    const double r = quantile(ratio, 0.5);
    if (r > best.ratio) best = {quantile(amplitude, 0.5), line, r};
  }
  return best;
}

}  // namespace forcegate::diagnose
