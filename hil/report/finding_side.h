#pragma once
// Where a finding stands, for people.

#include "hil/diagnose/diagnosis.h"

namespace forcegate {

/// Its side, or that nothing in the records could tell it.
inline std::string shown_side(const Finding& f) { return f.side_witnessed ? f.side : "side unknown"; }

}  // namespace forcegate
