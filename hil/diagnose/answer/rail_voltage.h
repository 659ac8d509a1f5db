#pragma once
// The voltage of a rail: what a data sheet says of an amplifier that clips, where the fit knows a corner in newtons and a share.

#include <optional>

#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"

namespace forcegate::diagnose {

/// "rail_V": median of the output on rows that the finding puts 3 % of the force range or more beyond its corner. The uncertainty is the scatter of the
/// records' medians and half of what the output still rises from the nearer half of those rows to the farther one. Nothing where fewer than
/// two records reach the rail with ten rows, or where the output goes on rising by more than a tenth of its span.
std::optional<FoundParameter> rail_voltage(const CampaignInput& campaign, const ResidualChannel& channel, const ChosenEffect& chosen);

}  // namespace forcegate::diagnose
