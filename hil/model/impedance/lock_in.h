#pragma once
// Lock-in detection of a sampled sine: amplitude and phase against the source, and how well they are known.

#include <cstdint>
#include <span>

namespace forcegate::impedance {

/// v(t) = in_phase sin(2 pi f t) + quadrature cos(2 pi f t) + mean, V.
struct Phasor {
  double in_phase_V = 0, quadrature_V = 0, mean_V = 0;
  double u_V = 0;  ///< standard uncertainty of either part, from the noise at neighbouring frequencies
  double third_harmonic = 0;  ///< amplitude at 3 f over that at f; NaN where 3 f cannot be sampled
  std::size_t clipped = 0;    ///< samples at or beyond the given rail
};

/// Whole periods only: of the samples, the largest number that holds whole periods (to a tenth of a sample) is used.
/// f_Hz in (0, rate_Hz/2), at least one period. `rail_V`: output voltage from which a sample counts as clipped.
/// Noise: mean power at the eight nearest frequencies that are whole in the window (none at f, 2f, 3f), so that coloured
/// noise is counted where it matters.
Phasor lock_in(std::span<const std::int16_t> codes, double f_Hz, double rate_Hz, double volts_per_code,
               double rail_V);

/// Mean of the samples and its standard uncertainty from the means of eight blocks (noise is coloured).
struct Level {
  double mean_V = 0, u_V = 0;
  std::size_t clipped = 0;
};
Level direct_level(std::span<const std::int16_t> codes, double volts_per_code, double rail_V);

}  // namespace forcegate::impedance
