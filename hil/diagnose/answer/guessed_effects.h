#pragma once
// What the model has as a guess and these records bear out: nothing is missing there, but whoever asks what moves the output wants to know.

#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Adds a finding below a claim for every effect of the model that no fit has estimated (Candidate::is_guess) and without which `fit`, the
/// model with what was claimed, loses clearly (first_gain of SelectionRules, a tenth of the unexplained); a note for one that these records do not show.
void tell_guessed_effects(const Workspace& workspace, const MixedFit& fit, double first_gain, Diagnosis& out);

}  // namespace forcegate::diagnose
