#pragma once
// The plan of a campaign: which records, in which order, over which range, after which rest.

#include <cstdint>
#include <string>
#include <vector>

#include "rigs/emulated/hidden/conditions.h"
#include "rigs/emulated/hidden/waves.h"

namespace forcegate::hidden {

/// 5 to 13 records: a slow ramp first, two long sines, the kinds in `required` (with multiplicity) and a draw
/// of the rest. `minutes` is the length of the long sines; the other records scale down with it but never
/// below what their kind needs. Held-out records are chosen so that the fit keeps one of every required kind
/// it can.
std::vector<RecordPlan> draw_protocol(std::uint64_t seed, const Conditions& conditions,
                                      const std::vector<std::string>& required, double minutes);

}  // namespace forcegate::hidden
