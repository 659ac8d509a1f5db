#pragma once
// `forcegate laws`: what a fitted parameter depends on, from a table with one row for each record.

#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/diagnose/laws/parameter_level.h"

namespace forcegate {

struct LawsRequest {
  std::filesystem::path table;    ///< CSV; "f_Hz" is covariate f in Hz, "u_b" the standard uncertainty of b
  std::vector<std::string> of;    ///< parameters
  std::vector<std::string> over;  ///< covariates; empty: every other column
  std::vector<std::string> law;   ///< terms that the law has already
  std::string scale = "linear";   ///< linear, log, reciprocal
  double alpha = 0.05;            ///< of a false dependence, over all parameters asked for
  std::uint64_t seed = 1;
};

/// Columns are named with their unit or without it. Covariates of the law need not be listed in `over`. Errors: a column that is not there, a parameter
/// that stands in its own law, more than a quarter of the rows with a gap (usage); those of missing_dependence. Rows with a gap in what is asked for are
/// left out, and columns of text are no covariates: `notes`, if given, get that.
Result<std::vector<ParameterAnswer>> laws(const LawsRequest& request, std::vector<std::string>* notes = nullptr);
std::string laws_text(const std::vector<ParameterAnswer>& answers);
std::string laws_json(const std::vector<ParameterAnswer>& answers, const std::vector<std::string>& notes = {});

}  // namespace forcegate
