#pragma once
// Whether the reference scatters by more than it is allowed to.

#include <optional>
#include <vector>

#include "hil/diagnose/raw/health_claims.h"

namespace forcegate::diagnose {

/// Allowed is the declared noise, or else the declared resolution taken as one standard deviation, or what a ladder of values explains.
/// Against it stand the scatter of quiet records, as far as the output does not share it, and that where the output stands still.
std::optional<HealthClaim> claim_of_reference_noise(const std::vector<RecordHealth>& health, const HealthScales& scales, const BenchFacts& bench);

}  // namespace forcegate::diagnose
