#pragma once
// Codes that a converter never gives out, told from samples that a link has lost and from a rail.

#include <vector>

#include "hil/diagnose/raw/raw_health.h"

namespace forcegate::diagnose {

/// Of the runs of one value in all records: where some codes are missing, the output stands at the edge of the gap, at the same few values each
/// time, comes to them from nearby, and goes on beyond them. A lost link holds whatever came last, or falls to its value, one and the same, from
/// anywhere; a rail has nothing beyond. Where lower bits stand still they are the rungs of a ladder, however many, and the highest is one of them.
struct HeldCodes {
  bool found = false;
  std::vector<double> value_V;  ///< in rising order
  double samples = 0.0;
};
HeldCodes find_held_codes(const std::vector<RecordHealth>& health, const HealthScales& scales);

}  // namespace forcegate::diagnose
