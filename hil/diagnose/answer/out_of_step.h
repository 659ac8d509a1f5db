#pragma once
// Output and reference that are out of step by less than two instruments may be. No campaign says by how much these are.

#include <optional>
#include <vector>

#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// A delay that is listed and not claimed, where a shift was carried along as nobody's fault and nothing else that is late was found.
std::optional<Finding> listed_out_of_step(const Workspace& workspace, const Selection& selection, const std::vector<Finding>& findings);

}  // namespace forcegate::diagnose
