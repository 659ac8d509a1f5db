#pragma once
// Runs of one value while the force moves on: held samples, falls to the low end, flat tops.

#include <span>
#include <vector>

#include "hil/diagnose/raw/raw_health.h"

namespace forcegate::diagnose {

struct SuspectRun {
  std::size_t begin = 0, end = 0;
  BadSample why = BadSample::held;  ///< held, zero or rail
  double error_V = 0.0;             ///< by which it misleads, half of what the force moved meanwhile
};

/// What a run is judged by, V unless the name says otherwise.
struct RunScales {
  double gain_V_per_N = 0.0;  ///< its size
  double U_range_V = 0.0, noise_F_N = 0.0, noise_U_V = 0.0, lsb_U_V = 0.0;
  bool rises = true;  ///< with the force
  double low_V = 0.0, high_V = 0.0;  ///< of the declared range
  double top_V = 0.0;                ///< largest output of the record
  double quiet_V = 0.0;              ///< StepsOfOutput
};

/// In the order of time. Held samples are let go with a jump to where the output has been meanwhile, or lack the noise that the output has; an
/// output that is merely late goes on as the force went. At the low end: down and up again though the force stays where it is.
std::vector<SuspectRun> find_suspect_runs(std::span<const double> F, std::span<const double> U, const RunScales& scales);

}  // namespace forcegate::diagnose
