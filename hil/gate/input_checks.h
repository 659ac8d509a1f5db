#pragma once
// What reached the firmware: were the sensor's codes in step with the ATI, and does the calibration that the firmware was
// given describe this sensor? Neither depends on the firmware.

#include <vector>

#include "hil/gate/case_record.h"
#include "hil/gate/plan.h"

namespace forcegate {

/// rig_sensor_sync: lag of the raw sensor force behind the ATI, at most 0.6 of the plan's limit for the firmware, which
/// then has the rest to itself; blames the link. rig_calibration_fits: before the film has lost anything the static law
/// gives the ATI's mean over the first 3 s and its first swing within 25 % and 0.1 N; blames the calibration. Verdicts are pass or rig_error.
std::vector<Check> input_checks(const Plan& plan, const CaseRecord& record);

}  // namespace forcegate
