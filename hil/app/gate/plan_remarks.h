#pragma once
// What a gate of a plan would stumble over although its file is right.

#include "hil/app/gate/plan.h"

namespace forcegate {

/// A case asks for an accuracy that the plan alone gives no limit of.
bool lacks_limits(const Plan& plan);
/// How the limits file that the plan names and that is not there comes to be.
std::string no_limits_file_help(const Plan& plan);

/// PlanEstimate::remarks and refused, as seen on the emulated rig. Errors: of that rig.
Result<void> remark_on(const Plan& plan, PlanEstimate& estimate);

}  // namespace forcegate
