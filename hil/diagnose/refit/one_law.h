#pragma once
// Joint fit of one law for all records, as a firmware has it. The diagnosis lets every record follow its own gain, offset,
// b and q within their spread, so that repeatability is not taken for an effect; what that leaves open (how much of a step is
// gain and how much is fast creep) an exported compensator must decide. Here there are no such liberties, and no record before: a firmware
// is switched on where a record begins:
//
//   U = g W(b, q) + o + g sum_j c_j s_j(W, F, history),   minimised over g, o, c (linear) and b, q (Newton on the
//   variable projection), every record weighing the same; for each effect the form and shape of its library entry that
//   predicts left-out records best, of those that the caller can use. Strengths may have either sign: what counts here is the
//   prediction, and which effect it is has been decided before. An equation of the user's own is fitted like a library entry: its
//   strength, and where no fit has been made of it yet, the best of the shapes around what was written.

#include <functional>
#include <string>
#include <vector>

#include "hil/model/model.h"
#include "hil/trace/campaign.h"

namespace forcegate::diagnose {

struct OneLawFit {
  Model model;
  struct Item {
    std::string record;
    double law_V = 0.0;  ///< RMS, law without effects, refitted too
    double model_V = 0.0;
  };
  std::vector<Item> records;
  double law_left_out_V = 0.0,
         left_out_V = 0.0;  ///< RMS over records that were left out of the linear fit in turn
  std::vector<std::string> notes;  ///< of the records; what a form that can be used costs against the best one
};

/// The error's text where the effects do not lower the error of records left out: a firmware is not better for them.
inline constexpr const char* kEffectsOfNoUse = "with one law for all records the effects do not lower the error of records left out";

/// Whether a model can be used, for instance inverted; empty: every one. Asked from the best form on, until one can.
using IsUsable = std::function<bool(const Model&)>;

/// Uncertainties in the model, of b and q too, are those of the jackknife over records. Where no form of an effect is usable, the best one is taken.
/// The rows are those that refit_campaign judges by: without spikes, lost and held samples, rails and hum.
/// Errors (config): fewer than 3 records that can be used, an effect that these records do not excite or whose channels are missing, the
/// effects do not lower the error of records left out (kEffectsOfNoUse); (parse): most of the output is not above 0, no usable rows.
Result<OneLawFit> fit_one_law(Campaign campaign, const Model& start, const IsUsable& is_usable = {}, unsigned threads = 0);

}  // namespace forcegate::diagnose
