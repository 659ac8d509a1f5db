#pragma once

#include <vector>

#include "hil/gate/case_record.h"
#include "hil/gate/plan.h"
#include "hil/gate/rule.h"

namespace forcegate {

/// What a record says about the image on its target, whatever the rig did: time of a sample, memory (lanes
/// that can tell), and the session before its RESET (cases with a prelude). Counts: exact, u = 0. `spoiled`: who made the
/// record unsound; the answers of that session are then no evidence (rig_error, that blame): a faulty rig decides nothing.
std::vector<JudgedCheck> judge_target(const Plan& plan, const CaseRecord& record, Blame spoiled);

}  // namespace forcegate
