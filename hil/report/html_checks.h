#pragma once
// Pieces of the HTML report of a run.

#include <string>
#include <vector>

#include "hil/interface/run_result.h"
#include "hil/report/judged.h"

namespace forcegate {

/// "ok", "no", "wa" or "mu": class that colours an element.
std::string_view html_class(Verdict verdict);
std::string_view html_class(DecisionKind kind);

/// Table of checks: verdict, check with evidence and limit source, value(u), limit, bullet bar.
std::string html_check_table(const std::vector<JudgedRow>& rows, const std::string& caption, bool with_case);

/// <details> of one case; `number` makes the anchor "case-N".
std::string html_case(const CaseResult& result, std::size_t number, bool open);

}  // namespace forcegate
