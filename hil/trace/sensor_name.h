#pragma once
// Which of the two sensors a lab's words are about, where no key declares it.

#include <string>
#include <string_view>
#include <vector>

namespace forcegate {

enum class NamedSensor { none, flexiforce, fsr };

/// "FSR 402", "Interlink 406", "U_FSR_V": fsr. "FlexiForce A201", beside the name of an FSR too: flexiforce. "fsr" within a longer word is none.
NamedSensor sensor_named_in(std::string_view text);

/// The first text that names a sensor, without the sign of a comment; "" where none does, or two name different ones.
std::string only_sensor_named(const std::vector<std::string>& texts);

}  // namespace forcegate
