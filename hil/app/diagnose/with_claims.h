#pragma once
// The model with all that a diagnosis claims, refitted, and the plain errors of both.

#include <optional>

#include "hil/diagnose/engine.h"
#include "hil/diagnose/refit/refit.h"

namespace forcegate {

/// Every claim that a model has a place for, one after the other; one that cannot be fitted is passed over. nullopt: there is none. `workspace`:
/// that of the diagnosis.
std::optional<diagnose::Refit> with_claims(const diagnose::Workspace& workspace, const Model& model, const Diagnosis& diagnosis, unsigned threads);

/// Whether a refit has to tell the plain errors: some record decays, and its prediction depends on where the law stands, which the search has
/// where it began.
bool is_plain_refitted(const diagnose::Workspace& workspace, const Diagnosis& diagnosis);

/// Sets them, of all records and of their mean, as compare and add tell them. `after`: the model with all claims; where it is none, those after are those
/// before if nothing is claimed, else NaN: the refit takes longer than the diagnosis, and is made for a page.
void tell_plain_as_refitted(const diagnose::Workspace& workspace, const diagnose::EngineOptions& options, const std::optional<diagnose::Refit>& after, Diagnosis& diagnosis);

}  // namespace forcegate
