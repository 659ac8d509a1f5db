#pragma once
// S0: where the force turns most sharply, its samples and those of the output at full rate. Rows are means over some 20 ms, in which a delay and a
// lag of a few milliseconds are alike; between two samples of an edge they are not.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hil/diagnose/raw/raw_health.h"
#include "hil/trace/campaign.h"

namespace forcegate::diagnose {

/// Of one record: stretches one behind the other in time, each with a run-up that tells a state what came before.
struct Edges {
  struct Window {
    std::size_t begin = 0, end = 0;  ///< places in `t_s`: what is judged
  };
  std::vector<double> t_s, F_N, U_V;   ///< t from the start of the record
  std::vector<std::uint32_t> sample;   ///< which sample of the record
  std::vector<Window> windows;         ///< in rising order, none overlaps
  double noise_F_N = 0.0;              ///< of a sample of the force, its step included
  double step_s = 0.0;                 ///< from one sample to the next

  bool empty() const { return windows.empty(); }
};

/// At most 40 windows of 60 ms or 17 samples, whichever is longer, in which the force turns by more than its noise does and no faster than its samples
/// tell, all samples are there and none is one of `bad` (BadSample, of every sample). `recorded_N`: the force before any smoothing, which would make of a
/// lag a delay. Empty where force and output have clocks of their own.
Edges edges_of(const Record& record, const std::vector<double>& recorded_N, const RecordHealth& health, std::span<const std::uint8_t> bad);

}  // namespace forcegate::diagnose
