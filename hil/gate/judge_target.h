#pragma once

#include <vector>

#include "hil/gate/case_record.h"
#include "hil/gate/plan.h"
#include "hil/gate/rule.h"

namespace forcegate {

/// What a record says about the image on its target, whatever the rig did: time of a sample, memory (lanes
/// that can tell), and the session before its RESET (cases with a prelude). Counts: exact, u = 0. Without a sound link
/// the answers of that session are no evidence: rig_error, blame link.
std::vector<JudgedCheck> judge_target(const Plan& plan, const CaseRecord& record, bool link_sound);

}  // namespace forcegate
