#pragma once
#include <string>

#include "hil/characterize/capacitance/weight_summary.h"

namespace forcegate {

/// The study as one JSON document, format 1, kind "capacitance". NaN is written as null. `sensors`: with every sensor of
/// every pack.
std::string weight_json(const characterize::WeightStudy& study, const characterize::WeightSummary& summary,
                        bool sensors = true);

}  // namespace forcegate
