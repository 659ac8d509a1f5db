#pragma once
// The way that the load has gone, N: sum |dF| from turn to turn, over records and the cycles between them. Wear counts it, and slow states are charged by it.

#include "hil/model/record_input.h"

namespace forcegate {

/// Least way back that is a turn of the force: ten times the noise of a row in the quietest record (noise alone spans eight of them in an hour), and 0.5 % of the
/// span. What turns by less is noise or a wandering zero, and wears nothing.
double least_turn_N(const CampaignInput& campaign);

/// travel_N, travel_before_N of the records in their order, and travel_total_N. A turn counts whole once it is one.
void add_up_travel(CampaignInput& campaign);

}  // namespace forcegate
