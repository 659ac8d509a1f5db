#pragma once
// What a plan's calibration makes of a sensor that has the model's effects, found by simulating the protocol on the model:
// slow sweeps with a straight line through them, then the identification record with U_max = U_min + a exp(-b t) + c.

#include "hil/gate/plan.h"
#include "hil/model/compensator/compensator.h"
#include "hil/model/model.h"

namespace forcegate {

/// The map of b and c/a is fitted over +-30 % around the model's own values, at the temperature where the effects are zero: the
/// model's own, else `temperature_C`. Errors: of the
/// model's equations, also when one of them asks for the temperature and none is given, or for the angle; config when the plan does not identify a specimen and asks for it, or its identification record is not a cyclic one.
Result<CalibrationMap> calibration_map(const Model& model, const Plan& plan, double temperature_C = kMissing);

}  // namespace forcegate
