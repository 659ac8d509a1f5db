#pragma once
// Spikes of a few samples: an electric discharge behind a filter rises within a sample and is gone after a few, a bad contact throws a few
// samples up and down. Their neighbours know of them.

#include <cstddef>
#include <vector>

namespace forcegate::diagnose {

inline constexpr std::size_t kLongestSpike = 4;  ///< samples

struct ShortSpike {
  std::size_t begin = 0, length = 0;  ///< samples
  double peak_V = 0.0;                ///< above or below the line between its surroundings
  bool both_ways = false;             ///< above and below
};

struct SpikeScales {
  double quiet_V = 0.0;      ///< what noise and steps do between two samples
  double gain_V_per_N = 0.0; ///< of the sensor, without its sign: what the force does is no spike
};

/// Excursions of 2 to kLongestSpike samples that end where they began: to both sides, or within 40 ms to one, largest at their first sample and
/// falling after it. A record with three to both sides may have any to one side. `t_s`, `F` and `U` on one clock; samples that are missing belong to none.
std::vector<ShortSpike> find_short_spikes(const std::vector<double>& t_s, const std::vector<double>& F, const std::vector<double>& U, const SpikeScales& scales);

}  // namespace forcegate::diagnose
