#pragma once
// What EM takes for the spread of few records is too small: it divides by n, and one of the n squares went into the mean.

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Records of the fit that excite a column of Z, where they are records and no blocks of one recording; 0 there.
std::size_t records_of_column(const Workspace& w, const MixedFit& fit, int z);

/// sqrt(n / (n - 1)) of these, for a spread and for the uncertainty of its mean; 1 where that says nothing.
double of_few_records(std::size_t n);

}  // namespace forcegate::diagnose
