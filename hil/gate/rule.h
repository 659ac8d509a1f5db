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
//
// A plan may allow several looks: what is undecided only for want of evidence is measured in another session
// and judged again with all sessions together. Whoever looks K times errs up to K times as often, so each look
// gets the K-th part of both error probabilities (Bonferroni): coverage 1 - (1 - coverage) / K, Holm at
// alpha / K. Over all looks together the stated levels hold, however the looks depend on each other.

#include <string>
#include <vector>

#include "hil/interface/check.h"

namespace forcegate {

struct DecisionRule {
  std::string name = "guarded";  ///< "guarded": marginal is not accepted; "simple": marginal is accepted
  double alpha = 0.01;           ///< family-wise probability of a false rejection
  double coverage = 0.9545;
  int looks = 1;  ///< most sessions of a record, the first included
  double coverage_per_look() const { return 1.0 - (1.0 - coverage) / looks; }
  double alpha_per_look() const { return alpha / looks; }
  std::string to_text() const;  ///< one line for reports
};

/// A check on its way to a verdict. dof: degrees of freedom behind u, 0 = many.
struct JudgedCheck {
  Check check;
  double dof = 0.0;
  bool judgeable = true;  ///< false: verdict and blame are already final (rig_error, not_run ...)
  /// More sessions of this case make the random part of u smaller; the systematic part stays.
  bool repeatable = false;
  double u_systematic = 0.0;
  /// What the record shows of a calibration that is not the sensor's may be this much of the value. A build is not rejected
  /// for it; nothing passes by it.
  double explained = 0.0;
};

/// Applies the rule to all checks of a run together; Holm runs over the required judgeable ones with u > 0.
void apply_rule(const DecisionRule& rule, std::vector<JudgedCheck*>& checks);

/// The judged checks for which another session can lead to ACCEPT: every required check is passed or undecided
/// only because of its uncertainty, and none of the undecided ones stays within k times its systematic part of
/// its limit, which no session makes smaller, even if the value moves by k times its random part. Empty when
/// another session cannot help. Call apply_rule first.
std::vector<const JudgedCheck*> worth_another_session(const DecisionRule& rule,
                                                      const std::vector<JudgedCheck*>& checks);

/// Zone of one check without the multiple-testing step.
Verdict zone(const Check& check, double expanded_U);

/// One-sided probability of a value at least this far beyond the limit if the truth lies on it.
double exceedance_p(const Check& check, double dof);

}  // namespace forcegate
