#pragma once
// docs/paper.md: what the paper says, what ours measures, the ratio, and why they differ.

#include <string>
#include <vector>

#include "hil/characterize/population_study.h"
#include "hil/report/characterization/figures_of_the_paper.h"

namespace forcegate {

/// Markdown. `command` repeats the run; pictures are linked as pictures_folder/FILE. Holds no time of day and no speed:
/// the same study gives the same bytes.
std::string paper_markdown(const std::vector<characterize::SensorStudy>& studies,
                           const characterize::StudyPlan& plan, const std::vector<PaperPicture>& pictures,
                           const std::string& command, const std::string& pictures_folder);

}  // namespace forcegate
