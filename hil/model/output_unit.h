#pragma once
// The unit of a model's output: outputs are kept in the SI unit of their quantity, and a gain is by that.

#include <string>

#include "hil/base/result.h"

namespace forcegate {

/// Error (config): empty, no unit that is known (hil/base/units.h), or another one of its quantity than outputs are kept in ("mV").
Result<void> check_output_unit(const std::string& unit, const std::string& place);

}  // namespace forcegate
