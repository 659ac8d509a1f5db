#pragma once

#include "rigs/emulated/hidden/waves.h"

namespace forcegate::hidden {

/// Fills waves.setpoint_N (already sized) with the commanded force of the plan on the internal clock: the
/// lowest force until the excitation starts, then the profile of its kind.
void fill_setpoint(const RecordPlan& plan, Waves& waves);

}  // namespace forcegate::hidden
