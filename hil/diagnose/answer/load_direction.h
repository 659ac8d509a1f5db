#pragma once
// Which way the load moves. The sign of a difference of neighbours says that of the noise where the load is held, or moves slowly.

#include <vector>

#include "hil/model/record_input.h"

namespace forcegate::diagnose {

/// Of every row: 1 rising, -1 falling between turning points of the force, 0 held: over the 4 s before or after it the force stays within
/// 1 to 4 % of `range_N` (N, > 0), as the noise asks. The turning points come back by as much.
std::vector<double> load_direction(const RecordInput& record, double range_N);

}  // namespace forcegate::diagnose
