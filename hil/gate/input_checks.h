#pragma once
// What reached the firmware: were the sensor's codes in step with the ATI, and does the calibration that the firmware was
// given describe this sensor? Neither depends on the firmware.

#include <vector>

#include "hil/gate/case_record.h"
#include "hil/gate/plan.h"

namespace forcegate {

/// rig_sensor_sync: lag of the raw sensor force behind the ATI, at most 0.6 of the plan's limit for the firmware, which
/// then has the rest to itself; blames the link. rig_calibration_fits: before the film has lost anything the static law
/// gives the ATI's mean over the first 3 s and its first swing at most 4 % and 0.03 N (5 % and 0.05 N) above and 12 % and 0.05 N
/// below, where the specimen was calibrated for this record, within 25 % and 0.1 N where a calibration of another day was given; blames the calibration. Verdicts are pass
/// or rig_error, of a given calibration inconclusive.
std::vector<Check> input_checks(const Plan& plan, const CaseRecord& record);

/// How much of a relative error may be a calibration that is not the sensor's, by what the beginning of the record shows, of
/// which 3 % and 0.4 % a second of the first swing may be what the film has lost by then: of an output that is too high, and
/// of one that is too low. 0 with the type's nominal values on a bench, which are meant to be wrong, and where nothing can be told.
struct Misfit {
  double reads_high = 0.0, reads_low = 0.0;
};
Misfit calibration_misfit(const CaseRecord& record);

}  // namespace forcegate
