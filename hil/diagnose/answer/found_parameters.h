#pragma once
// What a finding's fit says in numbers with units.

#include <vector>

#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"

namespace forcegate::diagnose {

/// The physical ones where the family has them (hil/diagnose/answer/physical_parameters.h); else shapes and strengths of all forms of the
/// finding, for clipping behind the voltage of the rail (hil/diagnose/answer/rail_voltage.h). The uncertainty of each includes that of the others (hil/diagnose/answer/shape_covariance.h). `gain`: of the finding's fit over that
/// which the columns were made with; strengths are shares of the former.
std::vector<FoundParameter> found_parameters(const CampaignInput& campaign, const ResidualChannel& channel, const ChosenEffect& chosen, double gain);

}  // namespace forcegate::diagnose
