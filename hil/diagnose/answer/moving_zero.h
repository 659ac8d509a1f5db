#pragma once
// A zero that moves within the records: of the reference or of the output, and nothing says of which.

#include <optional>
#include <string>
#include <vector>

#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// A drift of the reference that is listed and not claimed, where zeros of the parts of a recording explain by far more of what their one law
/// leaves than gains of the parts do, and nothing was found of it among `findings`.
std::optional<Finding> listed_moving_zero(const Workspace& workspace, const Selection& selection, const std::vector<Finding>& findings);

struct MovingZero {
  Finding finding;
  std::string follows;  ///< "the time within the record, in which the zero moves by 50 mV"; empty where it is no more than listed
};
/// Of a campaign: a zero that wanders within the typical record by far more than instruments do, which every fit gives to the record itself
/// (add_waves, base/repeatability.h). From a fifth of a percent of the span on (RMS, median of the records of more than a minute) it is listed, from two
/// fifths on it is something that is missing, and the verdict no "none".
std::optional<MovingZero> moving_zero_of_records(const Workspace& workspace, const MixedFit& fit);
/// A creep that is smaller than the wander beside it is what the waves of it leave: it is limited in `findings`, and its name is open.
void leave_creep_to_moving_zero(const Workspace& workspace, const MixedFit& fit, std::vector<Finding>& findings);

}  // namespace forcegate::diagnose
