#pragma once
// From the measured facts of a record to its checks (GATE section 4): rig first, then coverage, then values.
// A pure function; nothing here touches a rig or a firmware, so that a stored record is judged again in the
// same way.

#include <string>
#include <vector>

#include "hil/gate/budget.h"
#include "hil/gate/case_record.h"
#include "hil/gate/limits.h"
#include "hil/gate/plan.h"
#include "hil/gate/rule.h"

namespace forcegate {

/// A value that the panel averages over its specimens.
struct PanelValue {
  bool usable = false;
  double value = 0.0;         ///< %
  double u_systematic = 0.0;  ///< common to all specimens
  std::string unit = "%";
};

struct JudgedCase {
  std::vector<JudgedCheck> checks;
  bool sound = false;  ///< the rig was sound and the record complete
  bool safety_stop = false;
  bool safety_cause_decided = true;
  std::string safety_text;
  bool harness_error = false;
  std::string harness_text;
  bool cancelled = false;
  PanelValue maxima, minima;  ///< closed loop: ATI against set-point
};

JudgedCase judge_case(const Plan& plan, const PlanCase& planned, const CaseRecord& record,
                      const DerivedLimits& limits);

/// Checks of the panel for one case with the check `promise`: means over the specimens. The panel is fixed,
/// so its mean is the measurand and the spread over its specimens no uncertainty of it; that is
///   u = sqrt(u_systematic^2 + u_repeat^2 / n),
/// u_repeat from the plan (what a record of one specimen varies by when it is made again). The spread is
/// reported.
std::vector<JudgedCheck> judge_panel(const Plan& plan, const PlanCase& planned,
                                     const std::vector<std::string>& specimens,
                                     const std::vector<const JudgedCase*>& judged);

}  // namespace forcegate
