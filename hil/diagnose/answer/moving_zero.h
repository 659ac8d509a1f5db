#pragma once
// A zero that moves during one recording: of the reference or of the output, and nothing says of which.

#include <optional>

#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// A drift of the reference that is listed and not claimed, where zeros of the parts of a recording explain by far more of what their one law
/// leaves than gains of the parts do, and nothing was found of it among `findings`.
std::optional<Finding> listed_moving_zero(const Workspace& workspace, const Selection& selection, const std::vector<Finding>& findings);

}  // namespace forcegate::diagnose
