#pragma once
// Whether the converter gives out wrong codes: some never come, or single samples are off by the weight of one bit.

#include <optional>

#include "hil/diagnose/raw/health_claims.h"
#include "hil/diagnose/raw/health_totals.h"
#include "hil/diagnose/raw/held_codes.h"

namespace forcegate::diagnose {

std::optional<HealthClaim> claim_of_held_codes(const HeldCodes& codes, const HealthTotals& totals, const HealthScales& scales);
std::optional<HealthClaim> claim_of_bit_errors(const HealthTotals& totals, const HealthScales& scales);

}  // namespace forcegate::diagnose
