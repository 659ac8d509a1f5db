#pragma once
// What a column means: name, unit and quantity out of a header, and the names under which Forcegate knows them.

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/units.h"
#include "hil/trace/trace.h"

namespace forcegate {

struct ColumnMeaning {
  std::string name;  ///< "F_ref"
  Unit unit;         ///< symbol "" when the header does not tell
  bool is_clock = false;
  std::string note;  ///< what was assumed; empty when the header said it all
};

/// "F_ref_mN", "Force (mN)", "Force [mN]", "Force / mN", "Force, mN", and a few bare names ("t", "F", "U", "theta", "temp"),
/// which are taken to be in SI units (temperature in degree Celsius). "velocity_mm_s" is a velocity and no clock.
ColumnMeaning meaning_of(std::string_view header);

/// "U_V" of "u_v": the name that differs from a header in nothing but capitals, which make another unit of it; empty for most.
std::string meant_but_for_capitals(std::string_view header);

/// What stands where a unit stands in a header and is none known here: "widgets" of "Force (widgets)", "g" of "load_g". After an underscore,
/// or as the whole header, only what is a unit somewhere; empty for most.
std::string unknown_unit(std::string_view header);

/// Gives foreign channels the names of docs/campaign.md where that is unambiguous: by common synonyms, else when the
/// trace has exactly one channel of the quantity; counts, conductance, resistance or current stand for a missing U.
/// Returns one note for each renamed channel. `headers`: of the channels, as the file writes them; may be empty.
std::vector<std::string> use_canonical_names(Trace& trace, const std::vector<std::string>& headers = {});

/// Headers of the channels that nothing reads: neither under a name of docs/campaign.md nor mapped to "unused". `headers`: of channels by name.
std::vector<std::string> unused_columns(const Trace& trace, const std::map<std::string, std::string>& headers = {});

/// The name under which Forcegate knows a common synonym: "F_ref" for "force", "U" for "voltage"; else the name itself.
std::string known_name(std::string_view name);

/// A second channel of one name gets its unit to it, and a number where that is not enough.
void make_names_unique(Trace& trace);

/// Suffix for a header: "F_ref" with unit "N" -> "F_ref_N", "cm/s" -> "_cm_s".
std::string header_of(std::string_view name, std::string_view unit);

}  // namespace forcegate
