#pragma once
// A drive that is late as a whole. Every drive is, and no campaign says by how much this one may be.

#include <optional>

#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// A motor that is listed and not claimed, where the drive is late and nothing else was found of it among `findings`.
std::optional<Finding> listed_late_drive(const Workspace& workspace, const std::vector<Finding>& findings);

}  // namespace forcegate::diagnose
