#pragma once
// May a record judge a build at all? The rig, what reached the firmware, the stop, whether the record is whole, the link.

#include "hil/gate/case_checks.h"
#include "hil/gate/judge.h"

namespace forcegate {

struct InputsFound {
  bool link_sound = true;
  bool calibration_fits = true;  ///< the one that was given, as far as the record tells
};

/// First of a record's checks: the self-check's, rig_sensor_sync, rig_calibration_fits, safety_stop, time_base, coverage, extrema_count,
/// link_intact. `checks` then knows what spoils the others, `out` whether the record is sound and how it was stopped.
InputsFound judge_inputs(const Plan& plan, const PlanCase& planned, const CaseRecord& record, CaseChecks& checks, JudgedCase& out);

}  // namespace forcegate
