#pragma once
// How a value with its uncertainty meets a limit (ISO 14253-1 zones, JCGM 106 guard bands).
//
//   value + U <= limit             pass            U = k u, k for 95.45 % (Student when the items are few)
//   value     <= limit < value + U marginal        inside, by less than U
//   value - U <= limit < value     inconclusive    outside, by less than U
//   limit < value - U              fail            if Holm at alpha over the required checks agrees, else
//   inconclusive
//
// A lower limit is the mirror image. u = 0 is an exact count: pass or fail. NaN is inconclusive.

#include <string>
#include <vector>

#include "hil/interface/check.h"

namespace forcegate {

struct DecisionRule {
  std::string name = "guarded";  ///< "guarded": marginal is not accepted; "simple": marginal is accepted
  double alpha = 0.01;           ///< family-wise probability of a false rejection
  double coverage = 0.9545;
  std::string to_text() const;  ///< one line for reports
};

/// Sets verdict and blame of every check that is still to be judged: verdict not_run with a limit and
/// evidence (see `judgeable`). dof: degrees of freedom behind u, 0 = many.
struct JudgedCheck {
  Check check;
  double dof = 0.0;
  bool judgeable = true;  ///< false: verdict and blame are already final (rig_error, not_run ...)
};

/// Applies the rule to all checks of a run together; Holm runs over the required judgeable ones with u > 0.
void apply_rule(const DecisionRule& rule, std::vector<JudgedCheck*>& checks);

/// Zone of one check without the multiple-testing step.
Verdict zone(const Check& check, double expanded_U);

/// One-sided probability of a value at least this far beyond the limit if the truth lies on it.
double exceedance_p(const Check& check, double dof);

}  // namespace forcegate
