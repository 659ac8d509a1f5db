#pragma once
// All shapes of a model's effects at once. Each was moved beside where the others stood; where one makes up for another (the lag of a sensor and
// that of its curve) turns of single moves crawl along a ridge.

#include <vector>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Gauss-Newton steps of the continuous shapes of `variants` with all coefficients of `fit`, each halved, twice at most, where the log evidence does not rise,
/// until it rises no more. Columns of the variants stand where the shapes end. Nothing, where fewer than two shapes are continuous.
void move_together(Workspace& workspace, const std::vector<int>& variants, MixedFit& fit, unsigned threads);

}  // namespace forcegate::diagnose
