#pragma once
// S7: what a residual holds before the frequency of its load first changes.

#include <vector>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Rows of every record as residual_rows() tells them, in the output's unit. Of a cyclic record whose frequency changes those before the first
/// change, less the gain and the zero, each with a drift, that fit them best: how the decay goes on behind it differs from law to law, and the
/// record's own gain, zero and decay have been fitted to all of it. Empty where fewer than 100 rows come before.
std::vector<std::vector<double>> before_changes_of_frequency(const CampaignInput& input, const ResidualChannel& channel,
                                                             std::vector<std::vector<double>> residual);

}  // namespace forcegate::diagnose
