#pragma once

#include "hil/gate/case_checks.h"
#include "hil/gate/case_record.h"
#include "hil/gate/plan.h"

namespace forcegate {

/// What the firmware put out, whatever the force: output_finite, output_bounded, output_spike, learning_window, and lag where the profile is
/// dynamic. After judge_inputs. `calibration_fits`: else forces beyond the bound are the calibration's.
void judge_output(const Plan& plan, const CaseRecord& record, bool calibration_fits, CaseChecks& checks);

}  // namespace forcegate
