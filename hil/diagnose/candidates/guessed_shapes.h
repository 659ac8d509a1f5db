#pragma once
// Shapes of the model's own effects that no fit has estimated: a model that comes with the program, or is written by hand, knows that a
// sensor lags and not by how much this one does.

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Moves the shapes of guessed model effects of the output channel (Candidate::is_guess) to where the log evidence of the model is largest,
/// starting from the file's value and from the family's grid, and notes where one moved. Where more than a tenth of the instruments' share (mean square) is left, other
/// forms of the effect are tried as well, and take its place for 20 nats. A shape that a fit has estimated stays.
void fit_guessed_shapes(Workspace& workspace, unsigned threads);

}  // namespace forcegate::diagnose
