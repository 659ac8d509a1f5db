#pragma once
// Numbers for tables that people read.

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>

namespace forcegate {

/// Three significant digits, from a thousand up to 1e12 all of them: "0.0012", "12.3", "14532", where %g says 1.45e+04.
inline std::string plain_number(double value) {
  return std::fabs(value) >= 999.5 && std::fabs(value) < 1e12 ? fmt::format("{:.0f}", value) : fmt::format("{:.3g}", value);
}

/// Two significant digits of how many times as large something is, from a hundred on without decimals: "3.4 times", "131 times".
inline std::string so_many_times(double factor) { return (std::fabs(factor) >= 99.5 ? plain_number(factor) : fmt::format("{:.2g}", factor)) + " times"; }

/// "1 record", "2 records".
inline std::string counted(std::size_t n, std::string_view what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

/// How people read an error in the unit of its column: volts and newtons in thousandths, siemens and amperes in millionths, ratios in percent,
/// counts and ohms as they are.
struct PrintedUnit {
  double factor = 1.0;
  std::string name;
};
inline PrintedUnit printed_unit(const std::string& unit) {
  if (unit == "V" || unit == "N") return {1e3, "m" + unit};
  if (unit == "S" || unit == "A") return {1e6, "u" + unit};
  if (unit == "1") return {1e2, "%"};
  return {1.0, unit};
}

/// "12.3", "over 50": no claim states more than 0.98 (49 to 1), and what a simulation or the evidence of rows that hang together promises beyond
/// it, a bench does not keep.
inline std::string odds_text(double odds) {
  constexpr double kMost = 50.0;
  return odds > kMost ? "over 50" : fmt::format("{:.3g}", odds);
}

}  // namespace forcegate
