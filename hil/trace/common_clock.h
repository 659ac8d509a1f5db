#pragma once
// Two clocks in one recording: those of two devices, or of a channel that has samples in few of the rows of a table.

#include <optional>
#include <string>

#include "hil/trace/trace.h"

namespace forcegate {

/// Force and output of two time bases: every channel is read at the instants of the slower of the two (the force's where they are alike) while both
/// run, along straight lines of at most two of its own steps, and one time base is left. Otherwise, where the reference force or the output of a shared clock has a sample in every second row or fewer (the median distance of its
/// samples), the trace is reduced to the instants of the sparser of the two. The others keep what they have there; in between (clocks that
/// never meet) they are read along straight lines of at most two of their own steps, an angle from the sample before. Fewer than 16 samples
/// are no clock. Returns what was done, nothing when nothing was.
std::optional<std::string> put_on_common_clock(Trace& trace);

}  // namespace forcegate
