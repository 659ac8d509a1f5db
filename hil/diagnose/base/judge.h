#pragma once
// The measure of a model's error: what it leaves of records that it was not fitted to.

#include <vector>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Mean square residual of every record, predicted: held-out records by a fit of the others, without any by leaving each
/// out in turn. Both models of a comparison may follow a record by the same spread, that of `freedom`.
struct Judged {
  std::vector<double> adapted, plain;
};
Judged judge(const ResidualChannel& channel, const MixedFit& fit, const MixedFit& freedom, JudgedBy by);

/// The freedom of records that follow their own decay alone.
MixedFit without_levels(const ResidualChannel& channel, MixedFit freedom);

/// The same where a record keeps the gain and the zero of all records, but may decay in its own way: what an effect between records changes.
std::vector<double> judge_levels(const ResidualChannel& channel, const MixedFit& fit, const MixedFit& freedom, JudgedBy by);

/// Mean over the records that judge: held-out ones, or all.
double judged(const ResidualChannel& channel, const std::vector<double>& mean_square, JudgedBy by);

/// Residual (adapted) of the chosen rows of every record, in the channel's unit.
std::vector<std::vector<double>> residual_rows(const ResidualChannel& channel, const MixedFit& fit);

}  // namespace forcegate::diagnose
