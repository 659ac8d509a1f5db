#pragma once
// S7: noise of the output that hangs together over time is no effect. An effect follows what the load does, or comes and goes; noise has
// one size in every record, however fast the load moves, and a bell curve.

#include <vector>

#include "hil/diagnose/answer/residual_map.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Whether what hangs together in the residual is noise: means of neighbouring rows have one RMS in all records (within a factor of 1.8 up,
/// 0.55 down of the median), and at high force that at low force, though the force moves at least three times as fast in one record as in
/// another; their kurtosis is that of a normal distribution; no third of their power is at one frequency; no map explains them; they stay below
/// 0.6 % of the span. Fewer than 4 records: never.
/// `residual`: per record of the channel, in its unit. `maps`: of the same residual.
bool is_coloured_noise(const CampaignInput& input, const ResidualChannel& channel, const std::vector<std::vector<double>>& residual,
                       const std::vector<ResidualMap>& maps);

}  // namespace forcegate::diagnose
