#pragma once
// What is borne out by the records and still no claim: imperfections that honest benches have, and causes that nobody recorded.

#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Lowers the probability of such a finding and says why in its evidence. To 0.2: a curve of less than 0.08 % of the channel's span (RMS); a
/// loop of less than 0.5 % where nobody reads an angle, or ahead of the command there; any that is narrower than twice its uncertainty; a
/// sensor's loop that runs ahead of the load by less than 1 % and either four steps of the reference, or three times what a late reference
/// explains; a zero of the reference that jumps from record to record by less than half its resolution; a rail that takes less than a tenth
/// of the slope, or that leaves 2.5 times the noise while the output rises beyond its last corner by a fifth of what it would without one; a bent spring of a bench whose law nobody declared and that leaves 1 % of the span or is left out nowhere; a push from the
/// side there that left-out records hardly gain by. To kNoClaim: a free course over the campaign in the name of an unrecorded channel.
void reserve(const Workspace& workspace, const ResidualChannel& channel, const MixedFit& base, Finding& finding);

/// To kNoClaim: a curve of a sensor beside a loop or beside wrong codes of the converter that are larger than it, whether or not these are
/// claimed. Loops whose elements do not close evenly over the force (Preisach) have a curve of their own, of up to their own size, and so have
/// codes; no record tells it from another one.
void leave_curves_to_larger_causes(std::vector<Finding>& findings);

/// To kNoClaim: spikes beside claimed steps of the converter's codes where they stand off (RMS) by less than half as much again as these steps
/// together.
void leave_spikes_to_codes(const Workspace& workspace, std::vector<Finding>& findings);

}  // namespace forcegate::diagnose
