#pragma once
// Units of a user's own equation: it is written in N, s, degC and rad, and nothing is converted.

#include <string>

#include "hil/base/result.h"
#include "hil/model/model.h"

namespace forcegate {

/// Error (config) where a parameter names a unit that is no product of those: 20000 "ms" would be taken for 20000 s. No unit is none named.
Result<void> check_unit_of_equations(const ModelParameter& parameter, const std::string& place);

}  // namespace forcegate
