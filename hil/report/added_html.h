#pragma once
// The page of `forcegate add`: what one effect more does to the error of records that were not fitted, in the frame of a diagnosis.

#include <string>
#include <vector>

#include "hil/report/diagnosis_html.h"
#include "hil/report/figures/plots.h"

namespace forcegate {

struct AddedEffect {
  struct Parameter {
    std::string name, unit;
    double before = 0.0, after = 0.0, u = 0.0;  ///< before: NaN where there was none
  };
  std::string effect;
  bool is_needed = true;  ///< the error falls
  bool helps_one_law = false;  ///< it does not, and that of one gain, zero and decay for all records does, plainly
  double error_before = 0.0, error_after = 0.0, floor = 0.0;  ///< as `add` prints them
  std::string unit;
  std::vector<figures::WaterfallStep> steps;  ///< effects of the model in their order, this one last
  std::vector<Parameter> parameters;
};

/// `view`: maps, records and overlays before and after; its first finding is the effect, with its evidence.
std::string added_html(const Diagnosis& view, const AddedEffect& added, DiagnosisPage page);

}  // namespace forcegate
