#pragma once
// Fitted strengths that no such effect has as a rule.

#include <string>
#include <vector>

#include "hil/model/model.h"

namespace forcegate {

/// Of the effects of the library: strengths at or beyond the least or most that the library gives them, whatever the file's own bounds are. One
/// sentence each.
std::vector<std::string> beyond_bounds_notes(const Model& model);

}  // namespace forcegate
