#pragma once
// What every view says about a check in the same words: order, symbols, ratio to the limit, values as text.

#include <map>
#include <string>
#include <vector>

#include "hil/interface/run_result.h"

namespace forcegate {

enum class Glyphs { unicode, ascii };

/// A check with the case it belongs to (nullptr: a check of the whole run).
struct JudgedRow {
  const Check* check = nullptr;
  const CaseResult* in_case = nullptr;
  double ratio = 0.0;  ///< ratio_to_limit
};

/// value / limit for an upper limit, limit / value for a lower one: above 1 is outside. NaN without a limit,
/// without a value, for "equal", and where the quotient has no meaning (limit <= 0).
double ratio_to_limit(const Check& check);

/// All checks: whole run first, then case by case, in the order of the result.
std::vector<JudgedRow> judged_rows(const RunResult& result);

/// Those that are not pass, worst first: required before not required, then fail, rig_error, inconclusive,
/// not_run, marginal, waived, then ratio descending, then place in the result.
std::vector<JudgedRow> rows_to_look_at(const RunResult& result);

/// Worst verdict of the required checks; not_run when there is none.
Verdict case_verdict(const CaseResult& result);
std::map<Verdict, int> count_cases(const RunResult& result);
/// "70 records: 68 pass, 1 fail, 1 inconclusive".
std::string record_counts(const RunResult& result);

std::string_view symbol(Verdict verdict, Glyphs glyphs);
std::string_view symbol(DecisionKind kind, Glyphs glyphs);
std::string_view word(Verdict verdict);  ///< "rig error" for rig_error, "not run" for not_run

/// "6.1(4) %" (k = 1), "12" for exact counts, "6.1 % (u n/a)" when u is unknown, "not measured" for NaN.
std::string value_text(const Check& check, Glyphs glyphs);
/// "<= 4.5 %", ">= 10 s", "= 0", "none".
std::string limit_text(const Check& check, Glyphs glyphs);

/// "0.97", "1824", "" for NaN.
std::string ratio_text(double ratio);

/// Levels used by the cases, "identified" or "nominal, identified".
std::string calibration_levels(const RunResult& result);

/// k of U = k u by the run's rule, the smallest where few degrees of freedom make it larger; NaN when no check has both.
double coverage_k(const RunResult& result);

/// Whether the run's rule accepts what is inside its limit by less than U.
bool accepts_marginal(const RunResult& result);

/// "" for ACCEPT, else who has to act: "the firmware", "the rig".
std::string who_must_act(Blame blame);

}  // namespace forcegate
