#pragma once
// What of a campaign is an input. A force that shows no more than the noise of its reference is none, nor one that wanders a little and that
// the output knows nothing of.

#include <string>

#include "hil/base/result.h"
#include "hil/diagnose/laws/movement.h"
#include "hil/trace/campaign.h"

namespace forcegate::diagnose {

/// Channel U, or the only one beside the force; nullptr: there are several.
const Channel* output_of(const Record& record);

/// Why the force of a record is no input.
enum class Stillness { moves, exact, noise, wanders };

Stillness stillness_of_force(const Record& record);

/// True when no record has an input: a force that moves, a wheel angle or a command that does, a recorded cause (temperature, humidity,
/// supply) that tells more of the output than time does, or levels of the force that differ from record to record. Such a campaign can only
/// tell about drift.
bool is_drift_only(const Campaign& campaign);

/// For records without an input: what their force does instead, in words.
std::string what_the_force_shows(const Campaign& campaign);

/// Errors (parse): the force moves and the output of every record shows nothing but white noise about one value.
Result<void> check_output_moves(const Campaign& campaign);

/// What a law is fitted to. Errors (parse): a record is too short, no record has an input, or the output never moves.
Result<void> check_shows_a_law(const Campaign& campaign);

}  // namespace forcegate::diagnose
