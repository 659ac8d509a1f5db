#pragma once
// Mains line (50 or 60 Hz, first and third harmonic, or their aliases) in U - a F.

#include <vector>

namespace forcegate::diagnose {

struct MainsLine {
  double amplitude_V = 0.0, frequency_Hz = 0.0;
  double mean_square_V2 = 0.0;  ///< of the line
  double ratio = 0.0;  ///< median over segments of the line's power over the larger of neighbours and force
};

MainsLine find_mains_line(const std::vector<double>& t_s, const std::vector<double>& F_N,
                          const std::vector<double>& U_V, double gain_V_per_N);

}  // namespace forcegate::diagnose
