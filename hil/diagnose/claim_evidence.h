#pragma once
// Plot data of what each claim does: the residual without it and with it, every other claim being in both, on records that neither fit saw.

#include "hil/diagnose/select.h"

namespace forcegate::diagnose {

/// Fills `series` of the claims that were chosen on the output. Each is of the record whose error falls most by the claim, of those that
/// cover the axis: one that is held out, else one of the three that gain most, left out of both fits. What acts from record to record shows in the mean of every record,
/// each left out in turn. A recording that is judged as a whole has no part that could be left out: it is fitted as a whole.
void add_claim_evidence(const Workspace& workspace, const Selection& selection, std::vector<Finding>& findings);

}  // namespace forcegate::diagnose
