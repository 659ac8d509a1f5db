#pragma once
// Line of the mains (50 or 60 Hz) or of its rectifier (100 or 120 Hz), first and third harmonic or their aliases, in U - a F. It stands at the
// mains' own frequency, to 0.2 % and the resolution of the record, and is no harmonic of a stronger lower line.

#include <array>
#include <vector>

namespace forcegate::diagnose {

/// What hums: mains, and the ripple of a supply behind a rectifier.
inline constexpr std::array kMains_Hz = {50.0, 60.0, 100.0, 120.0};

/// Below it a line that the sampling has folded is not told from the slow force.
inline constexpr double kSlowestLine_Hz = 4.0;

/// Power over that of neighbours and force from which on a line stands out.
inline constexpr double kPlainLine = 25.0;

/// Where sampling at rate_Hz puts a line: 0 to half the rate.
double folded_Hz(double line_Hz, double rate_Hz);

/// Whether the first or the third harmonic of a mains stays in sight at this rate; no rate (0): no.
bool can_show_mains(double mains_Hz, double rate_Hz);

/// Whether a line that was sampled at rate_Hz may be that of this mains: aliases of several fall on each other.
bool may_be_of_mains(double line_Hz, double mains_Hz, double rate_Hz);

struct MainsLine {
  double amplitude_V = 0.0, frequency_Hz = 0.0;  ///< as sampled and, for a plain line, as measured: folded to less than half the rate
  double mains_Hz = 0.0;                         ///< first harmonic before, one of kMains_Hz
  double rate_Hz = 0.0;  ///< of the samples, gaps left out; 0: too few of them
  double ratio = 0.0;    ///< median over segments of the line's power over the larger of neighbours and force; at most 1 where it is not the mains'
};

MainsLine find_mains_line(const std::vector<double>& t_s, const std::vector<double>& F_N,
                          const std::vector<double>& U_V, double gain_V_per_N);

}  // namespace forcegate::diagnose
