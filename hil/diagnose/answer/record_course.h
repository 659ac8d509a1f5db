#pragma once
// The course of one record as a fit sees it, on rows that the fit did not take: what is thinned before it is drawn shows a fast cycle as a
// slow one (Nyquist 1928).

#include <vector>

#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Residual (adapted) of `rows` of the k-th record of the channel of the output, in its unit: what residual_rows gives on the chosen rows.
std::vector<double> residual_on_rows(const Workspace& workspace, const MixedFit& fit, std::size_t k, const std::vector<std::size_t>& rows);

/// Measured (`before`) and modelled (`after`) output of the k-th record over time. Of a long record first, smallest, largest and last row of
/// some 700 stretches of time stand for all, of measured, modelled and their difference alike; NaN stands where rows without a sample lie
/// between. A record of 30 cycles or more is followed by a second series: five cycles of its middle, every row.
std::vector<EvidenceSeries> record_course(const Workspace& workspace, const MixedFit& fit, std::size_t k);

}  // namespace forcegate::diagnose
