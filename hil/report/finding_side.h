#pragma once
// Where a finding stands, for people.

#include <string>

#include "hil/diagnose/diagnosis.h"

namespace forcegate {

/// Its side, or that nothing in the records could tell it.
inline std::string shown_side(const Finding& f) { return f.side_witnessed ? f.side : "side unknown"; }

/// ", with creep, which is not claimed": what else than claims the error after holds, as the waterfall draws it hollow. Empty: nothing.
std::string unclaimed_share(const Diagnosis& diagnosis);

}  // namespace forcegate
