#pragma once
// Errors of the extrema of a record: mean relative error, and mean absolute error where the minima are too small for one.

#include "hil/gate/case_checks.h"
#include "hil/gate/judge.h"

namespace forcegate {

inline constexpr std::size_t kExtremaOfAccuracy = 4;  ///< two of each kind: one has no spread

/// Open loop: against the plan's or the derived limits. Closed loop: reported, and kept in `out` for the panel. After rig, link and coverage.
void judge_accuracy(const Plan& plan, const PlanCase& planned, const CaseRecord& record,
                    const DerivedLimits& limits, CaseChecks& checks, JudgedCase& out);

}  // namespace forcegate
