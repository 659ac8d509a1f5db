#pragma once
// Records whose gain and zero run further apart than a specimen repeats to, with no cause that was recorded.

#include <optional>
#include <string>

#include "hil/diagnose/base/mixed_model.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Scatter of the gain, as a share of it, that is no ordinary bench's. One sensor's gain differs by 9 to 10 % from session to session (Lebosse 2011, III-D): eight
/// records of 9 % show more than 15 % once in 145 times (chi squared), of 10 % once in 36.
inline constexpr double kFarGain = 0.15;

struct WideScatter {
  std::string note;     ///< for people
  std::string follows;  ///< "the record, whose gain scatters by 12 % and zero scatters by 0.2 N"; empty where the scatter is no more than a note
};

/// `fit`: gain and zero of every record beside all effects. `zeros_explained`: they have a cause, and gains alone are asked. Nothing where the spread is that of an ordinary bench: 3 % of gain, a zero of 1 % of
/// the span (RMS). From 15 % and 3 % on, and where it goes one way in the order of the records, it is more than a note.
std::optional<WideScatter> wide_scatter(const Workspace& workspace, const MixedFit& fit, bool zeros_explained = false);

}  // namespace forcegate::diagnose
