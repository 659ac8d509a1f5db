#pragma once
// Least-squares fit of the decay of the maxima, U_max(t) = U_min + a exp(-b t) + c (Lebosse 2011, eq. 3).
// From the maxima alone only U_min + c is determined: U_min must be given (mean of the minima).

#include <span>

#include "hil/base/result.h"

namespace forcegate {

struct DecayParameters {
  double a_V = 0, b_per_s = 0, c_V = 0;
  double u_a_V = 0, u_b_per_s = 0, u_c_V = 0;  ///< standard errors, from block residuals (autocorrelation allowed for)
  double rmse_V = 0;                           ///< eq. (8)
  int n = 0;
};

/// t_s from the start of the excitation, maxima in volts, at least 6 points, b searched over
/// [1e-5, 1] 1/s on a logarithmic grid (variable projection), then refined. Error (parse) when the
/// maxima do not determine a decay: fewer than 6, not finite, or spanning less than 1/10 of the found 1/b.
Result<DecayParameters> fit_decay(std::span<const double> t_s, std::span<const double> maxima_V, double u_min_V);

}  // namespace forcegate
