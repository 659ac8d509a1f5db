#pragma once
// Where the residual sits: cell means against some twelve coordinates, ranked by the share of its variance that the
// cells predict on rows they were not made from.

#include <vector>

#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Residual (adapted) of the chosen rows of every record, in the channel's unit.
std::vector<std::vector<double>> residual_rows(const ResidualChannel& channel, const MixedFit& fit);

/// Maps of the residual, largest share first.
std::vector<ResidualMap> residual_maps(const Workspace& workspace, const ResidualChannel& channel,
                                       const std::vector<std::vector<double>>& residual,
                                       unsigned threads = 1);

/// Share of the residual's variance that is carried by something smoother than `block` rows: structure, not noise.
double autocorrelated_share(const std::vector<std::vector<double>>& residual, std::size_t block);

}  // namespace forcegate::diagnose
