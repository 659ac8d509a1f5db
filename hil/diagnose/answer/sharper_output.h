#pragma once
// What was left to a late reference and is no lateness: a reference behind a causal filter is late wherever it is dull. A mass between
// reference and sensor (U ~ F - m F''), or a reference smoothed on both sides, makes the output sharper without a lead.

#include "hil/diagnose/choose/search.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Where leads and lags of up to 30 ms together take most of what the law fails by, at least twice what the best one of them does, and 0.1 % of
/// the span more (RMS over rows): no "none", and claims within the records are withdrawn.
void tell_sharper_output(const Workspace& workspace, const Selection& selection, unsigned threads, Diagnosis& out);

}  // namespace forcegate::diagnose
