#pragma once
// Spikes with a tail: an electric discharge behind a filter rises within a sample and is gone after a few, and its neighbours know of it.

#include <cstddef>
#include <vector>

namespace forcegate::diagnose {

inline constexpr std::size_t kLongestSpike = 4;  ///< samples

struct ShortSpike {
  std::size_t begin = 0, length = 0;  ///< samples
  double peak_V = 0.0;                ///< above or below the line between its surroundings
};

struct SpikeScales {
  double quiet_V = 0.0;      ///< what noise and steps do between two samples
  double gain_V_per_N = 0.0; ///< of the sensor, without its sign: what the force does is no spike
};

/// Excursions of 2 to kLongestSpike samples and at most 40 ms to one side that are largest at their first sample, fall after it and end where
/// they began. `t_s`, `F` and `U` on one clock; samples that are missing belong to none.
std::vector<ShortSpike> find_short_spikes(const std::vector<double>& t_s, const std::vector<double>& F, const std::vector<double>& U, const SpikeScales& scales);

}  // namespace forcegate::diagnose
