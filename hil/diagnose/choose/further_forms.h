#pragma once
// An effect is seldom one form at one shape: a creep of several decades, a loop of several widths. What a model file can hold
// is a few forms of the family side by side.

#include <vector>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Variants of the family that go on lowering the error of records that were left out, by more than its standard error, beside
/// the columns of `fit`; at most two. Adds their columns to `present` and leaves the fit with them in `fit`.
std::vector<int> further_forms(const ResidualChannel& channel, const EffectKind& kind,
                               std::vector<int>& present, MixedFit& fit);

}  // namespace forcegate::diagnose
