#pragma once
// The study as one JSON document, format 1: spreads, laws, every session's values and decays. No curves.

#include <filesystem>
#include <string>
#include <vector>

#include "hil/characterize/population_study.h"

namespace forcegate {

/// NaN is written as null. `sessions` = false leaves the single sessions out. `files`: what was written of the study, told
/// where there is any.
std::string study_json(const std::vector<characterize::SensorStudy>& studies,
                       const characterize::StudyPlan& plan, bool sessions = true,
                       const std::vector<std::filesystem::path>& files = {});

}  // namespace forcegate
