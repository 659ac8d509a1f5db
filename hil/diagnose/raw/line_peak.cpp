#include "hil/diagnose/raw/line_peak.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "hil/base/quantile.h"
#include "hil/diagnose/raw/mains_line.h"

namespace forcegate::diagnose {

namespace {

// Turned down by `f_Hz` and averaged over a second, four times a second: what is within a hertz of it.
std::vector<std::complex<double>> around_line(const Seen& seen, double f_Hz, double rate_Hz) {
  const auto length = static_cast<std::size_t>(rate_Hz), hop = std::max<std::size_t>(1, length / 4);
  std::vector<double> window(length), y(seen.U.size());
  for (std::size_t i = 0; i < length; ++i)
    window[i] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(length));
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = std::isfinite(seen.at(i)) ? seen.at(i) : i > 0 ? y[i - 1] : 0.0;
  std::vector<std::complex<double>> out;
  for (std::size_t begin = 0; begin + length <= y.size(); begin += hop) {
    double mean = 0.0;
    for (std::size_t i = 0; i < length; ++i) mean += y[begin + i] / static_cast<double>(length);
    Rotation phase(2.0 * std::numbers::pi * f_Hz / rate_Hz);
    std::complex<double> sum = 0.0;
    for (std::size_t i = 0; i < length; ++i, phase.step()) sum += window[i] * (y[begin + i] - mean) * std::complex(phase.re, -phase.im);
    out.push_back(sum * std::polar(1.0, -2.0 * std::numbers::pi * std::fmod(f_Hz * static_cast<double>(begin) / rate_Hz, 1.0)));
  }
  return out;
}

}  // namespace

LinePeak peak_beside(const Seen& seen, double f_Hz, double rate_Hz) {
  constexpr double kFurthest_Hz = 0.75, kLongest_s = 64.0;
  const std::vector<std::complex<double>> z = around_line(seen, f_Hz, rate_Hz);
  const double step_s = static_cast<double>(std::max<std::size_t>(1, static_cast<std::size_t>(rate_Hz) / 4)) / rate_Hz;
  const std::size_t length = std::min(z.size(), static_cast<std::size_t>(kLongest_s / step_s));
  if (length < 2) return {0.0, kFurthest_Hz};
  const double resolution_Hz = 1.0 / (static_cast<double>(length) * step_s);
  LinePeak out{0.0, resolution_Hz};
  double most = -1.0;
  const auto steps = static_cast<int>(4.0 * kFurthest_Hz / resolution_Hz);
  for (int k = -steps; k <= steps; ++k) {
    const double off_Hz = 0.25 * resolution_Hz * k;
    double power = 0.0;
    for (std::size_t begin = 0; begin + length <= z.size(); begin += std::max<std::size_t>(1, length / 2)) {
      Rotation phase(2.0 * std::numbers::pi * off_Hz * step_s), hann(2.0 * std::numbers::pi / static_cast<double>(length));
      std::complex<double> sum = 0.0;
      for (std::size_t i = 0; i < length; ++i, phase.step(), hann.step()) sum += (0.5 - 0.5 * hann.re) * z[begin + i] * std::complex(phase.re, -phase.im);
      power += std::norm(sum);
    }
    if (power > most) most = power, out.off_Hz = off_Hz;
  }
  return out;
}

namespace {

// Mean power at a line and its ratio to what is beside it, in parts of some seconds.
struct Standing {
  double power = 0.0, ratio = 0.0;
};

Standing standing_at(const Seen& seen, double f_Hz, double rate_Hz) {
  constexpr double kPart_s = 4.0;
  constexpr std::size_t kParts = 8;
  const std::size_t n = seen.U.size(), length = std::min(n, static_cast<std::size_t>(kPart_s * rate_Hz)), parts = std::min(kParts, n / length);
  std::vector<double> power, ratio;
  for (std::size_t k = 0; k < parts; ++k) {
    const std::size_t from = k * (n - length) / std::max<std::size_t>(1, parts - 1);
    const auto power_at = [&](double Hz) {
      Rotation phase(2.0 * std::numbers::pi * Hz / rate_Hz), hann(2.0 * std::numbers::pi / static_cast<double>(length));
      std::complex<double> sum = 0.0;
      for (std::size_t i = 0; i < length; ++i, phase.step(), hann.step())
        if (const double y = seen.at(from + i); std::isfinite(y)) sum += (0.5 - 0.5 * hann.re) * y * std::complex(phase.re, phase.im);
      return std::norm(sum);
    };
    double at = 0.0;
    for (const double by_Hz : {-0.25, 0.0, 0.25}) at = std::max(at, power_at(f_Hz + by_Hz));
    std::vector<double> beside;
    for (const double by_Hz : {-3.0, -2.25, -1.5, 1.5, 2.25, 3.0})
      if (f_Hz + by_Hz > 1.0 && f_Hz + by_Hz < 0.5 * rate_Hz) beside.push_back(power_at(f_Hz + by_Hz));
    power.push_back(at);
    ratio.push_back(at / std::max(1e-300, quantile(std::move(beside), 0.5)));
  }
  return {quantile(std::move(power), 0.5), quantile(std::move(ratio), 0.5)};
}

}  // namespace

double cycles_per_s(const std::vector<double>& F, double rate_Hz) {
  constexpr double kBeyond = 0.1;
  constexpr std::size_t kFewest = 4;
  double sum = 0.0, n = 0.0, low = HUGE_VAL, high = -HUGE_VAL;
  for (const double v : F)
    if (std::isfinite(v)) sum += v, n += 1.0, low = std::min(low, v), high = std::max(high, v);
  if (!(high > low)) return 0.0;
  const double mean = sum / n, beyond = kBeyond * (high - low);
  std::size_t first = 0, last = 0, times = 0;
  bool below = false;
  for (std::size_t i = 0; i < F.size(); ++i) {
    below = below || F[i] < mean - beyond;
    if (!below || !(F[i] > mean + beyond)) continue;
    below = false;
    if (times++ == 0) first = i;
    last = i;
  }
  return times > kFewest ? static_cast<double>(times - 1) * rate_Hz / static_cast<double>(last - first) : 0.0;
}

bool is_harmonic_of_another(const Seen& seen, double f_Hz, double mains_Hz, double rate_Hz) {
  constexpr int kHighest = 16, kOfMains = 8;
  constexpr double kSame_Hz = 0.5;
  const double own = standing_at(seen, f_Hz, rate_Hz).power;
  for (int n = 2; n <= kHighest && f_Hz / n > kSlowestLine_Hz; ++n) {
    bool of_mains = false;
    for (int h = 1; h <= kOfMains; ++h) of_mains = of_mains || std::abs(f_Hz / n - folded_Hz(h * mains_Hz, rate_Hz)) < kSame_Hz;
    if (of_mains) continue;
    const Standing first = standing_at(seen, f_Hz / n, rate_Hz);
    if (!(first.ratio > kPlainLine && first.power > own)) continue;
    if (n <= 3) return true;
    for (const int before : {n - 1, n - 2}) {
      const Standing s = standing_at(seen, f_Hz * before / n, rate_Hz);
      if (s.ratio > kPlainLine && s.power > own) return true;
    }
  }
  return false;
}

bool is_of_load(const Seen& seen, double f_Hz, double rate_Hz) {
  constexpr double kSame_Hz = 0.3, kAsStrong = 0.3;
  const double load_Hz = cycles_per_s(seen.F, rate_Hz);
  if (!(load_Hz > kSame_Hz) || std::abs(f_Hz - load_Hz * std::round(f_Hz / load_Hz)) > kSame_Hz) return false;
  const double own = standing_at(seen, f_Hz, rate_Hz).power;
  const auto stands = [&](int below) {
    const double at_Hz = f_Hz - below * load_Hz;
    return at_Hz > 0.5 * load_Hz && standing_at(seen, at_Hz, rate_Hz).power > kAsStrong * own;
  };
  return (stands(1) && stands(2)) || (stands(2) && stands(4));
}

}  // namespace forcegate::diagnose
