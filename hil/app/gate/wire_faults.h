#pragma once
// Faults that a bench of twins declares, against what a gate plays on it.

#include "hil/app/gate/gate.h"
#include "hil/gate/plan.h"

namespace forcegate {

/// A fault that begins when every record of the gate has ended would do nothing and pass for one that was survived.
/// Errors (config): that, with its line; those of the bench file.
Result<void> check_wire_faults(const GateRequest& request, const Plan& plan, bool calibrates);

}  // namespace forcegate
