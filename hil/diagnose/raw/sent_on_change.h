#pragma once
// A logger that sends a value only when it has moved by a step of its own: between two of them the output stands still, and nothing is lost.

#include <optional>
#include <vector>

#include "hil/diagnose/raw/raw_health.h"

namespace forcegate::diagnose {

/// That step, V: the output stands for long while the force is slow and shortly while it is fast, and what the force does meanwhile is the same each
/// time. A link that loses samples does so for a time, and the force goes as far as it goes.
std::optional<double> step_of_sent_changes(const std::vector<RecordHealth>& health);

}  // namespace forcegate::diagnose
