#pragma once
// Whether the mains hum in the output.

#include <cstddef>
#include <optional>
#include <vector>

#include "hil/diagnose/raw/health_claims.h"

namespace forcegate::diagnose {

/// A line far above its neighbours and of a size that matters.
bool shows_hum(const RecordHealth& health, const HealthScales& scales);

/// What hums: a mains, or its rectifier, or the one in some records and the other in the rest; two of kMains_Hz, the same or not.
struct LinesOfHum {
  double first_Hz, second_Hz;
};

/// How many records show one of the lines, and how many can: of those whose rate folds both onto the slow nothing can be told.
struct RecordsOfHum {
  std::size_t show = 0, can_show = 0;
};
RecordsOfHum records_of_hum(const std::vector<RecordHealth>& health, const HealthScales& scales, const LinesOfHum& lines);

/// Two records show it, or the only one that can, and half of those that can.
bool is_hum(const RecordsOfHum& records);

std::optional<HealthClaim> claim_of_hum(const std::vector<RecordHealth>& health, const HealthScales& scales);

}  // namespace forcegate::diagnose
