#pragma once
// The voltage of a rail: what a data sheet says of an amplifier that clips, where the fit knows a corner in newtons and a share.

#include <optional>

#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// "rail_V": median of the output on rows that the finding puts 3 % of the force range or more beyond its corner. The uncertainty is the scatter of the
/// records' medians and half of what the output still rises from the nearer half of those rows to the farther one. Nothing where fewer than
/// two records reach the rail with ten rows, or where the output goes on rising by more than a tenth of its span.
std::optional<FoundParameter> rail_voltage(const CampaignInput& campaign, const ResidualChannel& channel, const ChosenEffect& chosen);

/// How much the output rises beyond a rail at `corner_N` of the decayed force, share of what it would without one: from the lower to the upper half of the
/// forces that a record has there, however long it stands at each. 0: it stops. Nothing where no record moves there by ten times its noise.
std::optional<double> rise_beyond_rail(const Workspace& workspace, double corner_N);

}  // namespace forcegate::diagnose
