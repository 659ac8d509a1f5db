#pragma once
// docs/paper-capacitance.md and the sheet of a study of conductance and capacitance.

#include <string>
#include <vector>

#include "hil/characterize/capacitance/weight_summary.h"
#include "hil/report/characterization/figures_of_the_paper.h"

namespace forcegate {

/// Markdown; the same study gives the same bytes.
std::string weight_markdown(const characterize::WeightStudy& study,
                            const characterize::WeightSummary& summary,
                            const std::vector<PaperPicture>& pictures, const std::string& command,
                            const std::string& pictures_folder);

/// One HTML file for people.
std::string weight_sheet_html(const characterize::WeightStudy& study,
                              const characterize::WeightSummary& summary,
                              const std::vector<PaperPicture>& pictures, const std::string& command);

}  // namespace forcegate
