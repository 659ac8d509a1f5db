#pragma once
// Figures 4 and 6 to 11 of Paredes-Madrid 2010 drawn from pack 0 of a study.

#include <vector>

#include "hil/characterize/capacitance/weight_study.h"
#include "hil/report/characterization/figures_of_the_paper.h"

namespace forcegate {

/// In the order of the paper. One sensor of pack 0 is the exemplar.
std::vector<PaperPicture> weight_figures(const characterize::WeightStudy& study);

}  // namespace forcegate
