#pragma once
// What a league's figures are worth is seen beside two rules that need no engine: always "none", and naming
// the column that correlates best with the residual.

#include <string>

#include "hil/diagnose/workspace.h"

namespace forcegate {

/// The effect whose signature has the largest |r| with the residual of the base law, over the rows of all records
/// that may be fitted; rows count as independent, as in the usual t-test at 1 % over all columns (Bonferroni).
/// "none" where even that test is silent.
std::string largest_correlation(const diagnose::Workspace& workspace);

}  // namespace forcegate
