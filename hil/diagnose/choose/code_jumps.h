#pragma once
// Whether the output jumps at the codes where the upper bits of a converter change, seen beside these codes alone.

#include "hil/model/record_input.h"

namespace forcegate::diagnose {

/// Every passage of the output through a twentieth of the range about k/8 of it, where one of the three highest bits changes, is a regression of the
/// decayed force on U with a jump there; so is every passage about the places midway. True where the jumps of at least two of these codes
/// have one sign beyond doubt (mean over four passages and more, four standard errors, and half as much again as any place midway). What a law
/// leaves, bent or late, is smooth there and does not count. `low_V`, `range_V` of the converter.
bool jumps_at_codes(const CampaignInput& campaign, double low_V, double range_V);

}  // namespace forcegate::diagnose
