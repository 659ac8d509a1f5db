#pragma once
// Whether an effect between records makes a record predictable from the others: log predictive density of each record
// with strengths and law from the others alone, at the variances of the fit.

#include "hil/diagnose/mixed_model.h"

namespace forcegate::diagnose {

/// Largest share by which the variance of one component of the spread falls between two fits.
double spread_fall(const MixedFit& before, const MixedFit& after);

struct LeftOutGain {
  double total = 0.0;        ///< nats, summed over records
  double without_best = 0.0; ///< the same without the record that gains most: not one record's whim
};
LeftOutGain left_out_gain(const MixedProblem& problem, const MixedFit& before, const MixedFit& after);

}  // namespace forcegate::diagnose
