#pragma once
// Characterisation of a recording: a rig that cannot move plays what it has, and what the force did decides what can be
// learnt from it: a decay when it is cyclic, law (1) with linearity and hysteresis otherwise.

#include "hil/characterize/session.h"

namespace forcegate::characterize {

/// Cyclic: at least 12 turning points of a quarter of the force range, half-cycles shorter than 20 s on average. Turning
/// points are those of the ATI. The decay is that of the longest stretch in which the force swings alike (to a tenth of
/// the swing); where 12 turning points in a row do not, law (1) is given instead. A note of the sheet says what was cut,
/// and that there is no decay: a of eq. (3) not above 3 standard errors, or 0.5 % of the swing over the stretch. Cycles
/// before the stretch, of whatever swing, began the decay: b is told then, a and c are not. Samples at a rail of the
/// converter are in no static law, with a note; notes of the rig are notes of the sheet.
/// Errors: those of the rig; device when neither is possible (the force hardly moves).
Result<SessionSheet> characterize_recording(Rig& rig, const std::string& name, BenchProgress& progress);

}  // namespace forcegate::characterize
