#pragma once

#include "hil/gate/case_checks.h"
#include "hil/gate/case_record.h"
#include "hil/gate/plan.h"

namespace forcegate {

/// conformance, where the plan asks for it: the firmware's arithmetic against an independent implementation of the algorithm that it
/// announces. After judge_inputs; on a sound link it stands whatever the rig did.
void judge_conformance(const Plan& plan, const PlanCase& planned, const CaseRecord& record, bool link_sound, CaseChecks& checks);

}  // namespace forcegate
