#pragma once
// What the declared instruments may do along the very direction of an effect. A reference that moves in steps is wrong by one and the
// same amount for as long as its code stands still: a record of six levels holds some twelve independent errors, however many rows
// it has, and a curve fits them. Noise as such says little: an effect across it is seen far below its size.

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// RMS, share of the channel's scale, that the best variant of the family takes beside `base` from a channel in which the steps of the
/// reference are all there is. Steps from what the instruments may leave beyond white noise; mean over places of the steps.
double removed_from_steps(const ResidualChannel& channel, const MixedFit& base, const EffectKind& kind);

}  // namespace forcegate::diagnose
