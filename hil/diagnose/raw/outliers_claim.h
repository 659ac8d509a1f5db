#pragma once
// Whether samples stand far off their neighbours too often.

#include <optional>
#include <vector>

#include "hil/diagnose/raw/health_claims.h"
#include "hil/diagnose/raw/health_totals.h"

namespace forcegate::diagnose {

/// Whether the lone samples that stand off are those at steps of the converter's curve (go_back_and_forth), and most of all that do.
bool are_steps_of_converter(const std::vector<RecordHealth>& health);

std::optional<HealthClaim> claim_of_outliers(const std::vector<RecordHealth>& health, const HealthTotals& totals, const HealthScales& scales);

}  // namespace forcegate::diagnose
