#pragma once
// The stretch of a recording over which the cycles of the force are alike: only there does a loss of the sensor's
// maxima tell of the sensor and not of the force.

#include "hil/characterize/maxima.h"

namespace forcegate::characterize {

struct SteadyStretch {
  Extrema extrema;  ///< of the stretch, times as recorded; without its first and last turn where another stretch borders on them
  double begin_s = 0.0, end_s = 0.0;
  bool is_whole = true;  ///< all turning points of the recording are in it
};

/// The longest run of turning points in which the forces of the maxima, and those of the minima, lie within
/// `tolerance` of the swing of the run, 1, and no cycle takes more than twice as long as another. Empty extrema
/// where two turning points in a row are not there.
SteadyStretch longest_steady_stretch(const Extrema& all, double tolerance);

}  // namespace forcegate::characterize
