#pragma once
// The air and the sensor's drive as a lab writes them into a note: "slow press, RH 39 %", "oven at 45 degC", "supply 3.3 V".

#include <cstddef>
#include <string_view>
#include <vector>

#include "hil/trace/air_notes.h"

namespace forcegate {

/// A number with its unit, and for what is no temperature in degrees the word that says what it is. Nothing of a quantity that the text gives
/// two values of, nor of a change ("warmed by 3 degC", "0.2 degC/min"), a tolerance or a range.
AirNotes air_in_words(std::string_view text);

/// A list of a number for each of `records`, behind the words that say what it is: "RH % per run: 47 56 54", "air at the start of each run, degC: 21.4; 22.6".
/// Empty: the text has none, or several of one quantity.
std::vector<AirNotes> air_in_list(std::string_view text, std::size_t records);

}  // namespace forcegate
