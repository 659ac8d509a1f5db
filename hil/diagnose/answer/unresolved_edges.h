#pragma once
// Edges that the sampling does not resolve. Where a row holds one sample and the force runs through much of its range between two of them, a
// millisecond between two honest instruments is a large error of a few rows: it is no structure of which something could be learnt.

#include <vector>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// The residual of the chosen rows of every record without the rows at such edges. A record that moves so fast most of the time keeps them all.
std::vector<std::vector<double>> without_unresolved_edges(const CampaignInput& input, const ResidualChannel& channel,
                                                          std::vector<std::vector<double>> residual);

}  // namespace forcegate::diagnose
