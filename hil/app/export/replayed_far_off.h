#pragma once
// Records whose replay leaves far more than their fit did: what a firmware has to find out by itself.

#include <string>

#include "hil/app/export/compensator_check.h"
#include "hil/diagnose/refit/one_law.h"

namespace forcegate {

/// One sentence that names the records replayed to more than five times what the fit leaves of them, of these the ones within a factor of two of
/// the worst; "" where there is none. `gain_N_per_V`: of the law, either sign.
std::string replayed_far_off(const diagnose::OneLawFit& fit, const CompensatorCheck& check, double gain_N_per_V);

}  // namespace forcegate
