#pragma once
// The height of turning points that few samples show: a mean over samples around them would be lower than they are.

#include <span>

#include "hil/characterize/maxima.h"

namespace forcegate::characterize {

/// Samples in a cycle, from the median distance of the maxima; NaN where there are fewer than two.
double samples_per_cycle(std::span<const double> t_s, const Extrema& extrema);

/// Below 200 samples in a cycle, where the mean of five around a turn of a sine is more than 0.1 % of its amplitude too low: sets time and force
/// of every turn to the vertex of a parabola through five samples of the force (three, below 16 in a cycle) and the sensor to its own parabola at
/// that time; a turn whose samples lie in no such curve keeps what it has. Time in s ascending, force in N, sensor in V, of equal length.
void sharpen_turns(std::span<const double> t_s, std::span<const float> force_N, std::span<const float> sensor_V, Extrema& extrema);

}  // namespace forcegate::characterize
