#pragma once
// Errors in variables, seen where the force stands still. What smoothing leaves of the reference's noise comes and goes from row to row; a
// loop that is no wider flattens it, as any better smoothing would, and the output, which never saw it, is fitted better. An effect of the
// load has one value there for as long as the load stands.

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Share of the fall of the squares from `before` to `after`, over all rows, that is made of scatter within groups of five neighbouring rows
/// over which the reference moves by less than 1 % of the span; beyond 1 where the rest grows. 0 without such groups or without a fall.
double share_of_jitter(const ResidualChannel& channel, const MixedFit& before, const MixedFit& after);

}  // namespace forcegate::diagnose
