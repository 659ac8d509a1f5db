#pragma once
// Figures 4-13 of Lebosse 2011 drawn from the exemplar's curves of a study.

#include <string>
#include <vector>

#include "hil/characterize/population_study.h"
#include "hil/report/figures/figure.h"

namespace forcegate {

struct PaperPicture {
  std::string file;     ///< "fig06.svg"
  std::string place;    ///< "Fig. 6"
  std::string caption;  ///< what the paper shows and what ours shows, one or two sentences
  figures::Figure figure;
};

/// Those whose curves are there, in the order of the paper.
std::vector<PaperPicture> figures_of_the_paper(const std::vector<characterize::SensorStudy>& studies);

}  // namespace forcegate
