#pragma once
// S7: a line of one frequency in the output that is neither the mains' nor the load's: a machine, a converter, a loop that rings.
// From one row to the next it scatters as noise does, and the noise that everything is held against is taken from there.

#include <optional>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

struct SteadyLine {
  double frequency_Hz = 0.0;  ///< as the rows show it: folded to less than half their rate
  double amplitude_V = 0.0;   ///< in the output's unit
};

/// In windows of 256 rows that follow each other, of what the output has there beside a parabola over time, the force and its rate: half of the
/// power of most windows at one frequency, the same in all of them, three cycles of it in a window at least, nothing else a fifth of it; the
/// load has less there, and it is none of the load's first eight harmonics. In half of the records that have some windows, and two of them
/// where there are two. Its amplitude is 0.15 % of the span at least, and more
/// than a saw-tooth of the instruments' steps has, visible or declared. Hum that was claimed has been taken off the rows.
std::optional<SteadyLine> steady_line(const Workspace& workspace);

}  // namespace forcegate::diagnose
