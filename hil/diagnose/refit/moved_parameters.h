#pragma once
// How far a refit moved each parameter of the effects of the library, by name.

#include <vector>

#include "hil/diagnose/refit/refit.h"

namespace forcegate::diagnose {

/// Strengths, then shapes, effect by effect; of what is new those shapes that were fitted or that its form takes from a grid, with NaN before.
/// Entries of one form are paired by the distance of their shapes. Named "creep.p"; where an effect stands in the model more than once,
/// "lag.two_poles.c", and where that form does, with its shape: "hysteresis.play_bank[kept=0].w3".
std::vector<ParameterMove> moved_parameters(const std::vector<ModelEffect>& before, const std::vector<ModelEffect>& after);

}  // namespace forcegate::diagnose
