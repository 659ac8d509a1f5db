#pragma once
// What one effect more changes on a campaign, in the pictures of a diagnosis.

#include <string>

#include "hil/base/result.h"
#include "hil/diagnose/engine.h"

namespace forcegate::diagnose {

/// Records, maps and overlays before and after, with the effect as the only finding and its evidence. `workspace`: prepared with the effect
/// in in_model and without a search; linearised where the model before stands, or, with it in model_effects, where the refitted one does; `before`: the options of the model without it. Errors (config): the records cannot show the effect, or
/// do not determine the model.
Result<Diagnosis> show_added(Workspace& workspace, const EngineOptions& before, const std::string& effect);

/// What `from` shows of the model after, in place of what `to` shows of it: each is linearised where its model stands. Nothing, where they judge
/// by different measures.
void take_after(const Diagnosis& from, Diagnosis& to);

}  // namespace forcegate::diagnose
