#pragma once
// A reference whose zero moves without load (between/unloaded_zero.h), claimed.

#include "hil/diagnose/base/mixed_model.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Form of such a finding.
inline constexpr const char* kUnloadedZero = "unloaded";

/// Claims reference_drift by it, where nothing else does and no claim of the rig explains the zeros (those of the sensor cannot).
void claim_unloaded_zero(const Workspace& workspace, const MixedFit& fit, Diagnosis& out);

}  // namespace forcegate::diagnose
