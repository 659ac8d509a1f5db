#pragma once
// What a gate of a plan would stumble over although its file is right.

#include "hil/app/gate/plan.h"

namespace forcegate {

/// PlanEstimate::remarks and refused, as seen on the emulated rig. Errors: of that rig.
Result<void> remark_on(const Plan& plan, PlanEstimate& estimate);

}  // namespace forcegate
