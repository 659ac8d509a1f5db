#pragma once
// `forcegate gate` with a plan of kind "capacitance-gate": a firmware that reads conductance and capacitance.

#include "hil/app/gate.h"

namespace forcegate {

/// Whether the request's plan is of that kind. Errors: no such plan.
Result<bool> is_weight_gate(const GateRequest& request);

/// Takes firmware, plan, lane, seed, only_cases (names of sensors), output of the request. One session of the image for each
/// sensor, in a process of its own; the same result and reports as gate(). Errors: of the request and the bench; what the
/// image does wrong is in the decision.
Result<RunResult> weight_gate(const GateRequest& request, const GateProgress& progress = {}, const std::atomic<bool>* cancelled = nullptr);

}  // namespace forcegate
