#pragma once
// Whether the output goes on growing, or sinks back, where the force stands still.

#include "hil/model/record_input.h"

namespace forcegate::diagnose {

/// Holds: 10 s and more in which the force keeps within a hundredth of the range; their first 2 s, in which loops close and lags end, do not
/// count, nor do cyclic records, whose base law moves in holds too. The output there, about its mean in each, goes with growth by the logarithm of
/// time under load (and back after it) as the whole record drives it: k by least squares in every hold. True where four and more holds have one k
/// of five standard errors, taken from how it scatters from hold to hold, and those in which it grows and those in which it sinks back have half of it each.
/// A loop, a curve and a zero that drifts have no such k.
bool grows_in_holds(const CampaignInput& campaign);

}  // namespace forcegate::diagnose
