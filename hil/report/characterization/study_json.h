#pragma once
// The study as one JSON document, format 1: spreads, laws, every session's values and decays. No curves.

#include <string>
#include <vector>

#include "hil/characterize/population_study.h"

namespace forcegate {

/// NaN is written as null. `sessions` = false leaves the single sessions out.
std::string study_json(const std::vector<characterize::SensorStudy>& studies,
                       const characterize::StudyPlan& plan, bool sessions = true);

}  // namespace forcegate
