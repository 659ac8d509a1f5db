#pragma once
// A contact that opens in a few records only: too few for a law of all, and plain where it happens.

#include <optional>
#include <vector>

#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// contact_loss where the force stands at its zero while the rig's law, the line of the record's closed contact over angle or command, goes on
/// below it: again and again between two loads (a protocol may begin or end with a gap), by three times what the line leaves of most rows and 1.5 % of the range, and
/// what is left of the law's slope is a fifth at most. Nothing where `findings` have it claimed. `series`: of the record
/// in which it opens farthest.
std::optional<Finding> contact_that_opens(const Workspace& workspace, const std::vector<Finding>& findings);

}  // namespace forcegate::diagnose
