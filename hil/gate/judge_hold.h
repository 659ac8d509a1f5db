#pragma once

#include "hil/gate/case_checks.h"
#include "hil/gate/case_record.h"
#include "hil/gate/plan.h"

namespace forcegate {

/// hold_amplification, where the plan asks for it: |firmware / static law - 1| in % over a force that is held after cycling. `sound`: the rig was,
/// and the record is whole; it is not known else.
void judge_hold(const Plan& plan, const PlanCase& planned, const CaseRecord& record, bool sound, CaseChecks& checks);

}  // namespace forcegate
