#pragma once
// Single samples that stand off their neighbours by more than noise, steps of the values and the force explain.

#include <cstddef>
#include <vector>

#include "hil/diagnose/raw/range_ends.h"
#include "hil/diagnose/raw/record_scales.h"

namespace forcegate::diagnose {

/// In rising order, and where the output is at each without it.
struct LoneSamples {
  std::vector<std::size_t> at;
  std::vector<double> level_V;
};

struct OffTheirNeighbours {
  LoneSamples at_low_end;  ///< of the range
  LoneSamples spikes;      ///< elsewhere; what comes before and behind knows nothing of them
};
OffTheirNeighbours find_lone_samples(const ForceAndOutput& samples, const StepsOfOutput& steps, const RecordScales& scales);

}  // namespace forcegate::diagnose
