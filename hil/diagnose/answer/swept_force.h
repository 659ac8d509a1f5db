#pragma once
// Whether a shift that grows with time is one that grows with the frequency of the force.

#include "hil/model/record_input.h"

namespace forcegate::diagnose {

/// Correlation over the rows of all records of t dF/dt, which clocks that run apart add, with f(t) dF/dt, f the frequency at which the force moves
/// there, beside what gain and zero of each record and one delay take of both. 0 without rows, 1 in a linear sweep.
double time_as_frequency(const CampaignInput& campaign);

}  // namespace forcegate::diagnose
