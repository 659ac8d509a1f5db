#pragma once
// S6: where a command jumps, the force is on its way, and a rig without an angle says nothing of it.

#include <vector>

#include "hil/model/record_input.h"

namespace forcegate::diagnose {

/// Takes out of `rows` those at a jump of the record's rig_force_N and within a tenth of a second behind it, in which an ordinary drive comes
/// after: a row is too long to tell its lag from a play. A jump bends the command by 15 % of `range_N` from one row to the next. Nothing is
/// taken out where that would leave less than two fifths of the rows: such a command has no jumps, it is fast.
void leave_out_command_jumps(const RecordInput& record, double range_N, std::vector<std::size_t>& rows);

}  // namespace forcegate::diagnose
