#pragma once
// Units by suffix: "F_ref_mN" -> channel "F_ref", newton, factor 1e-3. Everything inside Forcegate is
// in SI base or derived units except temperature (degree Celsius), as the column names say.

#include <optional>
#include <string>
#include <string_view>

namespace forcegate {

struct Unit {
  std::string symbol;     ///< as written, "mN"
  std::string canonical;  ///< unit we store, "N"
  std::string quantity;   ///< "force"
  double factor = 1.0;    ///< canonical = factor * written + offset
  double offset = 0.0;
};

/// Looks a symbol up ("mN", "degC", "kPa"); the signs for micro, degree and ohm are known. Empty when unknown. Case matters: "mN" is not "MN".
std::optional<Unit> find_unit(std::string_view symbol);

/// A unit as a text shows it: that of a number without one, "1", is none.
inline std::string_view unit_in_text(std::string_view unit) { return unit == "1" ? std::string_view() : unit; }

struct NamedColumn {
  std::string name;  ///< "F_ref"
  Unit unit;
};

/// Splits "F_ref_mN" at the last underscore whose tail is a unit; empty when there is none.
std::optional<NamedColumn> split_unit_suffix(std::string_view column);

}  // namespace forcegate
