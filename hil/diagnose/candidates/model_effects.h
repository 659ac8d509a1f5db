#pragma once
// Effects that the model has already, as its file writes them: their form at their shape, of which the strengths are fitted anew.

#include <string>
#include <vector>

#include "hil/diagnose/engine.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// One candidate for each effect of the library that acts on the output and that the campaign's channels allow. No columns yet.
std::vector<Candidate> model_candidates(const CampaignInput& campaign, const std::vector<ModelEffect>& effects);

/// Whether the other effect has forms for acting together with this one.
bool acts_together(const EffectKind& other, const EffectKind& with);

/// The effect that the model lacks although it has what acts together with it: the curve of an FSR, of which its model says the lag alone. "": none.
std::string lacking_partner(const EngineOptions& options);

/// Whether the model's effects are as they come with the program, no one has been fitted: what such a model lacks every sensor of its kind has.
bool is_as_shipped(const EngineOptions& options);

/// What the base law is fitted beside, since it is no decay: the model's effects at their shapes and about their strengths; for a guess, which
/// may be wrong, all shapes of its grid at any strength, and the most flexible forms of what acts together with it.
std::vector<Candidate> beside_base_law(const CampaignInput& campaign, const std::vector<Candidate>& of_model);

/// Their columns, and those of the fitted equations of the user's own.
std::vector<int> model_columns(const ResidualChannel& channel, const EngineOptions& options);

/// All columns of their families, to soak up what their forms leave: that is no second effect.
std::vector<int> model_families(const ResidualChannel& channel, const EngineOptions& options);

}  // namespace forcegate::diagnose
