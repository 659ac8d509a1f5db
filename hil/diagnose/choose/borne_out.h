#pragma once
// Whether what was chosen lowers the error of records that were left out.

#include <vector>

#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Said of what is not borne out.
inline constexpr const char* kDoesNotFall = "the error of records left out does not fall";

/// Sets error_before, error_after and borne_out of what was chosen. What `stands_in` for something that was not borne out must itself lower
/// the error.
void measure_left_out(const Workspace& workspace, const ResidualChannel& channel, Selection& selection, bool stands_in = false);

/// What was chosen and is not borne out, as suspicions. After measure_left_out().
std::vector<Finding> not_borne_out(const ResidualChannel& channel, const Selection& selection);

}  // namespace forcegate::diagnose
