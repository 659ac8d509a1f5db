#pragma once
// From the measured facts of a record to its checks (docs/gate.md, 2 to 4): rig first, then coverage, then values.
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
  double u_readings = 0.0;    ///< Budget::u_of_readings()
  double u_scatter = 0.0;     ///< Budget::u_of_scatter()
  double explained = 0.0;     ///< JudgedCheck::explained
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

/// What one specimen gave in a case, one entry a session.
struct SpecimenSessions {
  std::string specimen;
  std::vector<JudgedCase*> sessions;
};

/// Checks of a case over all its records.
///
/// `promise` (closed loop): mean over the specimens of the mean over their sessions. The panel is fixed, its
/// mean is the measurand (a claim about these specimens, not about the population), so the spread between
/// specimens is reported but is no uncertainty of the mean. What varies from session to session of one specimen
/// is (calibration, identification, the record itself):
///   u = sqrt(u_systematic^2 + 1 / N^2 sum_i 1 / R_i^2 sum_r (s^2 + u_readings^2))     N specimens, R_i sessions r
/// s from the plan, or the record's own scatter where that is more: no mean is surer than its records are. Where the pooled standard
/// deviation within the specimens refutes the plan's (chi-square test at 1 %), the observed one with its sum (R_i - 1) degrees of
/// freedom; it holds the noise already, so the record's own random part counts only where it is more.
///
/// Accuracy (open loop) with more than one session: mean over the sessions of a specimen, the random part of u
/// divided by sqrt(R); the checks of its single records are no longer required. No session is left out.
std::vector<JudgedCheck> judge_panel(const Plan& plan, const PlanCase& planned,
                                     const std::vector<SpecimenSessions>& specimens);

}  // namespace forcegate
