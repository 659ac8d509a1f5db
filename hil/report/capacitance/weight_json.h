#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "hil/characterize/capacitance/weight_summary.h"

namespace forcegate {

/// The study as one JSON document, format 1, kind "capacitance". NaN is written as null. `sensors`: with every sensor of
/// every pack. `files`: what was written of the study, told where there is any.
std::string weight_json(const characterize::WeightStudy& study, const characterize::WeightSummary& summary,
                        bool sensors = true, const std::vector<std::filesystem::path>& files = {});

}  // namespace forcegate
