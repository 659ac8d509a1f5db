#pragma once
// Which records say something of which others, where every mounting has a gain and zero of its own.

#include <vector>

#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Per record, 1 where the others say something of it. 0: the only one of its mounting among those that may; no model foretells it, with the
/// effect of `variant` or without. All 1 for other effects, and where fewer than half of the records that judge are foretold.
std::vector<char> foretold_records(const ResidualChannel& channel, int variant, JudgedBy by);

/// Mean square errors of records that the others predict: one that is not foretold takes the mean of those that are, and changes no mean.
void set_unforetold_aside(const ResidualChannel& channel, int variant, JudgedBy by, std::vector<double>& mean_square);

}  // namespace forcegate::diagnose
