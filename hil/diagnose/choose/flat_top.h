#pragma once
// Whether the output stands still above a force and follows it right below.

#include "hil/model/record_input.h"

namespace forcegate::diagnose {

/// Slope of U over the decayed force W (least squares, every record about its own means) in all rows above `corner_N` and in those of the last
/// tenth of the range below it. True where the upper one, with two standard errors, is less than a fifth of the lower one. False where the force
/// hardly moves above the corner, or too few rows are there. A smooth curve, whatever its law, has much the same slope on either side.
bool stands_still_above(const CampaignInput& campaign, double corner_N);

}  // namespace forcegate::diagnose
