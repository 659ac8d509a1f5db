#pragma once
// A creep of seven time constants and a loop of six plays are no numbers that a person can use. Both are linear in their strengths, so
// that what a data sheet would say follows from a load that is put on and stays, or goes up and down once.

#include <vector>

#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/select.h"

namespace forcegate::diagnose {

/// All forms of the finding together, with standard uncertainties. creep: growth under constant load, share of the load per decade of time
/// between 1 s and 100 s (or the longest record), and in all by then. hysteresis, backlash: width of the loop at mid force, N and % of the
/// span, the force going once over it; negative where the way up lies higher. Empty for other effects.
std::vector<FoundParameter> physical_parameters(const CampaignInput& campaign, const ResidualChannel& channel,
                                                const ChosenEffect& chosen);

}  // namespace forcegate::diagnose
