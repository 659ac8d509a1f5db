#pragma once
// Whether samples of the output are lost: missing, held, silent, sent twice or at the low end while the force goes on.

#include <optional>
#include <vector>

#include "hil/diagnose/raw/health_claims.h"
#include "hil/diagnose/raw/health_totals.h"

namespace forcegate::diagnose {

/// `holds_lose_nothing`: runs of one value are codes that the converter holds (held_codes.h) or values that a logger sends anew only when they have
/// changed (sent_on_change.h), taken off `totals.held` already.
std::optional<HealthClaim> claim_of_dropouts(const std::vector<RecordHealth>& health, const HealthTotals& totals, const HealthScales& scales,
                                             bool holds_lose_nothing);

}  // namespace forcegate::diagnose
