#pragma once
// Errors in variables, seen where the force stands still. What smoothing leaves of the reference's noise comes and goes from row to row; a
// loop that is no wider flattens it, as any better smoothing would, and the output, which never saw it, is fitted better. An effect of the
// load has one value there for as long as the load stands.

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Share of the fall of the squares from `before` to `after`, over all rows, that is made where the reference moves by less than 1 % of the
/// span, or than its own noise does: of scatter within groups of five neighbouring rows, or of what goes with the reference in stretches of 20 to 100 (a long window
/// smooths the noise over many rows), whichever is more. Beyond 1 where the rest grows; 0 without such rows or without a fall. `is_shift`: of a
/// shift by a row and more, which flattens no noise and acts on the output just after an edge, or before it: of groups only those in the midst of a long standstill count.
/// Where there are 20 of these they speak for all groups of any effect: just behind an edge what is late goes on.
double share_of_jitter(const ResidualChannel& channel, const MixedFit& before, const MixedFit& after, bool is_shift = false);
/// Of it the fall of an effect of the load has next to nothing, that of a smoother two thirds and more.
inline constexpr double kOfJitter = 0.3;

}  // namespace forcegate::diagnose
