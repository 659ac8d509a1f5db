#pragma once
// Where a residual sits: cell means against some twelve coordinates, ranked by the share of its variance that the
// cells predict on rows they were not made from.

#include <vector>

#include "hil/diagnose/base/judge.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Maps of the output's residual, largest share first.
std::vector<ResidualMap> residual_maps(const Workspace& workspace, const std::vector<std::vector<double>>& residual, unsigned threads = 1);

/// Map of the rig's residual in newtons against the angle, in 36 cells. Only where an angle was recorded.
ResidualMap rig_map_of_angle(const Workspace& workspace, const std::vector<std::vector<double>>& residual_N);

/// Share of the residual's variance that is carried by something smoother than `block` rows: structure, not noise.
double autocorrelated_share(const std::vector<std::vector<double>>& residual, std::size_t block);

}  // namespace forcegate::diagnose
