#include "hil/model/output_unit.h"

#include <fmt/format.h>

#include "hil/base/text.h"
#include "hil/base/units.h"

namespace forcegate {

Result<void> check_output_unit(const std::string& unit, const std::string& place) {
  if (unit.empty()) return fail(ErrorCode::config, "output_unit is empty", place, "write the unit of the output (\"V\", \"S\"), or leave it out: volts");
  const std::optional<Unit> known = find_unit(unit);
  if (unit == "1" || (known && known->canonical == unit)) return {};
  if (known)
    return fail(ErrorCode::config, fmt::format("output_unit \"{}\": an output of that quantity is kept in {}", unit, known->canonical), place,
                fmt::format("write \"{0}\", and the gain in N/{0}", known->canonical));
  return fail(ErrorCode::config, fmt::format("output_unit \"{}\" is no unit that is known here", printable_utf8(unit)), place,
              "known are V, S (a resistance is read as conductance), A, F, counts (codes of a converter) and 1 (a ratio)");
}

}  // namespace forcegate
