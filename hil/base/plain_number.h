#pragma once
// Numbers for tables that people read.

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace forcegate {

/// Three significant digits, from a thousand on all of them: "0.0012", "12.3", "14532", where %g says 1.45e+04.
inline std::string plain_number(double value) {
  return std::fabs(value) >= 999.5 ? fmt::format("{:.0f}", value) : fmt::format("{:.3g}", value);
}

}  // namespace forcegate
