#pragma once
// Check (d): the candidate is no worse than the accepted build. Both are played on the same specimens with
// the same seeds, in turn on one rig; what is compared is the increase of the mean relative error, pair by
// pair, so that specimen, rig and reference cancel.
//
//   d_i = |e_i(candidate)| - |e_i(accepted)|   over the extrema i of one record, in percentage points
//   increase = mean over the records of mean(d_i),  u = sqrt(sum_r s_r^2 / n_r) / R
//
// s_r: standard deviation of d_i in record r, n_r its extrema, R records. Where both played
// their own record of a rig that does not repeat itself, sqrt(2 / R) times the plan's repeatability of a
// record is added in squares.

#include <span>
#include <string>
#include <vector>

#include "hil/gate/case_record.h"
#include "hil/gate/plan.h"
#include "hil/gate/rule.h"
#include "hil/interface/run_result.h"

namespace forcegate {

/// Why a record of the accepted build carries no comparison; pass: it does.
struct NoPartner {
  Verdict verdict = Verdict::pass;
  Blame blame = Blame::none;
  std::string evidence;
};

/// From the checks of that record. Its rig at fault: of one that was played now as of any record, of a stored one (`stored`)
/// whoever gave it, for played again it is the same.
NoPartner no_partner(const std::string& record, std::span<const Check> accepted, bool stored);

struct ErrorIncrease {
  std::string case_name, record;
  bool maximum = true;
  double increase_pct = 0.0;  ///< NaN when one of the two gave no value
  double u_pct = 0.0;
  std::size_t n = 0;
  NoPartner no_partner;
};

/// Two from each pair of records: maxima and minima; none when the case judges no accuracy, or its minima by
/// their absolute error. `partner`: what no_partner() found of the accepted one.
std::vector<ErrorIncrease> error_increases(const Plan& plan, const PlanCase& planned,
                                           const CaseRecord& candidate, const CaseRecord& accepted, const NoPartner& partner = {});

/// From the values of a stored run of the accepted build; u of both in squares, since the pairs are gone. Where the rig
/// repeats itself the systematic parts of both are one and the same and cancel.
std::vector<ErrorIncrease> error_increases(const PlanCase& planned, const std::string& record,
                                           std::span<const JudgedCheck> candidate, const CaseResult& accepted, bool repeats);

/// One required check for maxima and one for minima of every case: "no_worse_maxima/CASE". Verdicts are
/// final. `repeats`: the rig gives the same record again (emulated, or one recording).
std::vector<JudgedCheck> judge_no_worse(const Plan& plan, std::span<const ErrorIncrease> increases,
                                        bool repeats);

}  // namespace forcegate
