#pragma once
// Hum that the sampling has folded onto the slow: 50 Hz at 49.9 samples a second is a wave of ten seconds. Where other records show the line,
// what such a record is left with is hum too, and no structure of which something could be learnt.

#include <vector>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// 1 for the channel's records whose rate folds the line that at least two of the campaign's show.
std::vector<char> records_of_folded_hum(const Workspace& workspace, const ResidualChannel& channel);

}  // namespace forcegate::diagnose
