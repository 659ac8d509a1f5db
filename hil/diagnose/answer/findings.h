#pragma once
// From what was chosen to what is said: findings with probabilities.

#include <vector>

#include "hil/diagnose/answer/remainder.h"
#include "hil/diagnose/base/judge.h"
#include "hil/diagnose/choose/borne_out.h"
#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Adds what was chosen in one channel, and its rivals, after measure_left_out(). `explained`: share of what the noise does not explain.
void add_findings(const Workspace& workspace, const ResidualChannel& channel, const Selection& selection,
                  double explained, Diagnosis& out);

/// The strongest of what was refused becomes a suspicion, with the share of such that was there; where nothing else is told, the likeliest cause
/// between records does. After everything else was found.
void suspect_refused(const Workspace& workspace, const SelectionRules& rules, Diagnosis& out);

/// One residual has one cause in time: the effects of time share one probability, the one that can be spared least first.
void share_among_timing(const Selection& selection, std::vector<Finding>& findings);

/// Rivals that no more than odds of 4 : 1 part.
void tell_not_separable(const Selection& selection, Diagnosis& out);

}  // namespace forcegate::diagnose
