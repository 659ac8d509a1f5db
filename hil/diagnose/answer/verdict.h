#pragma once
// S9: known, unknown or none.

#include <vector>

#include "hil/diagnose/diagnosis.h"

namespace forcegate::diagnose {

/// What keeps an answer without a claim from being "none".
struct OpenPoints {
  bool follows_no_force = false;   ///< the output hardly follows the force (remainder.h)
  bool form_falls_short = false;   ///< the model has the effect, and its form leaves far more than the instruments may
  bool structure_is_left = false;  ///< Remainder::structured()
  bool claims_withdrawn = false;   ///< there was a claim, and something without a name explains more (withdrawals.h)
  bool name_is_open = false;       ///< there is something that any of several effects makes, or none was borne out
  bool leaves_far_more = false;    ///< Remainder::leaves_far_more()

  bool any() const { return follows_no_force || form_falls_short || structure_is_left || claims_withdrawn || name_is_open || leaves_far_more; }
};

/// Known where anything is claimed, unknown where a point is open, else none.
DiagnosisVerdict verdict_of(const std::vector<Finding>& findings, const OpenPoints& open);

/// What passed every test within the records and was not borne out by left-out ones, a free course over the campaign that was, or rivals that
/// hold most of the probability together, are no "none": there is something, and its name is open.
bool name_is_open(const Diagnosis& diagnosis, const std::vector<Finding>& not_borne_out);

}  // namespace forcegate::diagnose
