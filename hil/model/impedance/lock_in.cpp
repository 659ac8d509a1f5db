#include "hil/model/impedance/lock_in.h"

#include <cmath>
#include <complex>

#include "hil/base/portable_math.h"

namespace forcegate::impedance {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kNeighbours = 4;  // on either side
constexpr std::size_t kBlocks = 8;

// 2/N sum v e^{-j w t}: real part belongs to cos, minus the imaginary one to sin.
std::complex<double> correlate(std::span<const std::int16_t> codes, double cycles_per_sample,
                               double volts_per_code) {
  const double w = 2.0 * kPi * cycles_per_sample;
  const std::complex<double> turn{portable::cos(w), -portable::sin(w)};
  std::complex<double> carrier{1.0, 0.0}, sum{0.0, 0.0};
  for (const std::int16_t code : codes) {
    sum += static_cast<double>(code) * carrier;
    carrier *= turn;
  }
  return sum * (2.0 * volts_per_code / static_cast<double>(codes.size()));
}

std::size_t whole_periods(std::size_t n, double samples_per_period) {
  for (double periods = std::floor(static_cast<double>(n) / samples_per_period + 1e-9); periods >= 1.0;
       periods -= 1.0) {
    const double length = periods * samples_per_period;
    if (std::abs(length - std::round(length)) <= 0.1)
      return std::min(n, static_cast<std::size_t>(std::llround(length)));
  }
  return n;
}

std::size_t count_clipped(std::span<const std::int16_t> codes, double rail_code) {
  std::size_t clipped = 0;
  for (const std::int16_t code : codes) clipped += std::abs(static_cast<double>(code)) >= rail_code ? 1 : 0;
  return clipped;
}

}  // namespace

Phasor lock_in(std::span<const std::int16_t> codes, double f_Hz, double rate_Hz, double volts_per_code,
               double rail_V) {
  const std::span<const std::int16_t> window = codes.first(whole_periods(codes.size(), rate_Hz / f_Hz));
  const double n = static_cast<double>(window.size()), cycles = f_Hz / rate_Hz;
  Phasor out;
  const std::complex<double> at = correlate(window, cycles, volts_per_code);
  out.quadrature_V = at.real();
  out.in_phase_V = -at.imag();
  out.mean_V = 0.5 * correlate(window, 0.0, volts_per_code).real();
  out.third_harmonic = 3.0 * cycles < 0.5
                           ? std::abs(correlate(window, 3.0 * cycles, volts_per_code)) / std::abs(at)
                           : std::nan("");
  const double bin = std::round(cycles * n);
  double power = 0.0;
  int used = 0;
  for (int side : {-1, 1})
    for (int k = 1; k <= kNeighbours; ++k) {
      const double other = bin + side * k;
      if (other < 1.0 || other > 0.5 * n - 1.0 || other == 2.0 * bin || other == 3.0 * bin) continue;
      power += std::norm(correlate(window, other / n, volts_per_code));
      ++used;
    }
  out.u_V = used > 0 ? std::sqrt(0.5 * power / used) : std::nan("");
  out.clipped = count_clipped(window, rail_V / volts_per_code);
  return out;
}

Level direct_level(std::span<const std::int16_t> codes, double volts_per_code, double rail_V) {
  double means[kBlocks] = {}, mean = 0.0, squares = 0.0;
  const std::size_t each = codes.size() / kBlocks;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    for (std::size_t i = 0; i < each; ++i) means[b] += codes[b * each + i];
    means[b] *= volts_per_code / static_cast<double>(each);
    mean += means[b] / kBlocks;
  }
  for (const double m : means) squares += (m - mean) * (m - mean);
  return {mean, std::sqrt(squares / (kBlocks * (kBlocks - 1))),
          count_clipped(codes, rail_V / volts_per_code)};
}

}  // namespace forcegate::impedance
