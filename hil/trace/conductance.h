#pragma once
// A resistance as what a piezoresistive sensor makes of force.

#include "hil/trace/campaign.h"

namespace forcegate {

/// Where the output is a resistance R and, over all records, the conductance 1/R goes with the force more straightly (larger squared
/// correlation), every output becomes that conductance, siemens, and the campaign notes it. R <= 0 counts as missing. Records whose output
/// is no resistance leave all as they are.
void read_resistance_as_conductance(Campaign& campaign);

}  // namespace forcegate
