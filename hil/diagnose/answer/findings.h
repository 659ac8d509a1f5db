#pragma once
// From what was chosen to what is said: findings with probabilities, and errors of records that were left out.

#include <vector>

#include "hil/diagnose/answer/verdict.h"
#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// A finding about an effect, of errors in `unit`: nothing is said of it yet.
Finding finding_about(const EffectKind& kind, const std::string& unit);

/// Mean square residual of every record, predicted: held-out records by a fit of the others, without any by leaving each
/// out in turn. Both models of a comparison may follow a record by the same spread, that of `freedom`.
struct Judged {
  std::vector<double> adapted, plain;
};
Judged judge(const ResidualChannel& channel, const MixedFit& fit, const MixedFit& freedom, JudgedBy by);

/// The same where a record keeps the gain and the zero of all records, but may decay in its own way: what an effect between records changes.
std::vector<double> judge_levels(const ResidualChannel& channel, const MixedFit& fit, const MixedFit& freedom, JudgedBy by);

/// Mean over the records that judge: held-out ones, or all.
double judged(const ResidualChannel& channel, const std::vector<double>& mean_square, JudgedBy by);

/// Sets error_before, error_after and borne_out of what was chosen. What `stands_in` for something that was not borne out must itself lower
/// the error.
void measure_left_out(const Workspace& workspace, const ResidualChannel& channel, Selection& selection, bool stands_in = false);

/// What was chosen and is not borne out, as suspicions. After measure_left_out().
std::vector<Finding> not_borne_out(const ResidualChannel& channel, const Selection& selection);

/// Adds what was chosen in one channel, and its rivals, after measure_left_out(). `explained`: share of what the noise does not explain.
void add_findings(const Workspace& workspace, const ResidualChannel& channel, const Selection& selection,
                  double explained, Diagnosis& out);

/// The strongest of what was refused becomes a suspicion, with the share of such that was there; where nothing else is told, the likeliest cause
/// between records does. After everything else was found.
void suspect_refused(const Workspace& workspace, const SelectionRules& rules, Diagnosis& out);

/// One residual has one cause in time: the effects of time share one probability, the one that can be spared least first.
void share_among_timing(const Selection& selection, std::vector<Finding>& findings);

/// Rivals that no more than odds of 4 : 1 part.
void tell_not_separable(const Selection& selection, Diagnosis& out);

}  // namespace forcegate::diagnose
