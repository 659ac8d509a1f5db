#pragma once
// What one effect more changes on a campaign, in the pictures of a diagnosis.

#include <string>

#include "hil/base/result.h"
#include "hil/diagnose/engine.h"

namespace forcegate::diagnose {

/// Records, maps and overlays before and after, with the effect as the only finding and its evidence. `workspace`: prepared with the effect
/// in in_model and without a search; `before`: the options of the model without it. Errors (config): the records cannot show the effect, or
/// do not determine the model.
Result<Diagnosis> show_added(Workspace& workspace, const EngineOptions& before, const std::string& effect);

}  // namespace forcegate::diagnose
