#pragma once
// Which records say something of which others, where every mounting has a gain and zero of its own.

#include <vector>

#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Mean square errors of records that the others predict. A record that is the only one of its mounting among those that may say something of
/// it is predicted by none, with the effect and without it: it takes the mean of those that are. Nothing changes for other effects, nor where
/// fewer than half of the records that judge are predicted.
void set_unforetold_aside(const ResidualChannel& channel, int variant, JudgedBy by, std::vector<double>& mean_square);

}  // namespace forcegate::diagnose
