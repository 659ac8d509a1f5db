#pragma once
// The sensor's data sheet: one HTML file for people.

#include <string>

#include "hil/characterize/population_study.h"
#include "hil/report/characterization/figures_of_the_paper.h"

namespace forcegate {

/// `pictures` of both sensors; only those of the study's exemplar are shown.
std::string data_sheet_html(const characterize::SensorStudy& study, const characterize::StudyPlan& plan,
                            const std::string& command);

}  // namespace forcegate
