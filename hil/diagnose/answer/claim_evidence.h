#pragma once
// Plot data of what each claim does: the residual without it and with it, every other claim being in both, on records that neither fit saw.

#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

/// What the residual of a channel is drawn against, and what the residual is.
struct EvidenceAxes {
  std::vector<std::string> names;  ///< of "force", "rate", "time", "angle", "command"
  std::string residual;            ///< "residual", "F_ref less the rig's law"
};

/// Fills `series` of the claims that were chosen in this channel. Each is of the record whose error falls most by the claim, of those that
/// cover the axis: one that is held out where a tenth of its mean square goes, else one of the three others that gain most, left out of both
/// fits. What acts from record to record shows in the mean of every record, each left out in turn; in that of every eighth of a record where its
/// cause runs on within them. A recording that is judged as a whole has no part that could be left out: it is fitted as a whole.
void add_claim_evidence(const Workspace& workspace, const ResidualChannel& channel, const Selection& selection, const EvidenceAxes& axes,
                        std::vector<Finding>& findings);

}  // namespace forcegate::diagnose
