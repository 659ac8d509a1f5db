#pragma once
// Whether a refit left the model where it was.

#include "hil/model/model.h"

namespace forcegate::diagnose {

/// The same law and the same forms, and no parameter moved by more than a fiftieth of its standard error (by a thousandth, where none is known).
bool stands_still(const Model& before, const Model& after);

}  // namespace forcegate::diagnose
