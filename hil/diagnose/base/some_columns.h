#pragma once
// A mixed model narrowed to some columns of S: what a refit or a sum over them alone needs.

#include <vector>

#include "hil/diagnose/base/mixed_model.h"

namespace forcegate::diagnose {

/// The problem with those columns of S alone.
MixedProblem with_columns(const MixedProblem& problem, const std::vector<int>& columns);
/// A fit of the whole problem as one to start from in that with those columns alone: strengths and the numbers of the columns. Its covariance is not made over.
MixedFit with_columns(MixedFit fit, const std::vector<int>& columns);

}  // namespace forcegate::diagnose
