#pragma once

#include "hil/gate/case_checks.h"
#include "hil/gate/case_record.h"
#include "hil/gate/plan.h"

namespace forcegate {

/// output_excursion, N: of all extrema behind the start window the largest distance of the error firmware - ATI from the median error of the
/// 15 extrema of its kind before and the 15 behind it. What a correction that falls out for a few swings shows, and the mean over hundreds of
/// extrema does not. Only of an algorithm that nobody implemented a second time: of another one `conformance` says more.
void judge_excursion(const Plan& plan, const PlanCase& planned, const CaseRecord& record, CaseChecks& checks);

}  // namespace forcegate
