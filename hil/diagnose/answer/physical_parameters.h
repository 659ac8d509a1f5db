#pragma once
// A creep of seven time constants, a loop of six plays and a share of 1.3 that is late by 4 ms are no numbers that a person can use. What a
// data sheet would say follows from a load that is put on and stays, goes up and down once, or climbs steadily.

#include <vector>

#include "hil/diagnose/answer/shape_covariance.h"
#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"

namespace forcegate::diagnose {

/// All forms of the finding together, with standard uncertainties that include those of the shapes. creep: growth under constant load, share of the load per decade of time
/// between 1 s and 100 s (or the longest record), and in all by then. hysteresis, backlash: width of the loop at mid force, N and % of the
/// span, the force going once over it; negative where the way up lies higher. delay, lag: by how much the output is behind a steady ramp;
/// clock_skew: by how much more with every second. Empty for other effects.
std::vector<FoundParameter> physical_parameters(const CampaignInput& campaign, const ResidualChannel& channel, const ChosenEffect& chosen,
                                                const ShapeCovariance& joint);

}  // namespace forcegate::diagnose
