#pragma once
// Least-squares fit of the decay of the maxima, U_max(t) = U_min + a exp(-b t) + c (Lebosse 2011, eq. 3).
// From the maxima alone only U_min + c is determined: U_min must be given (mean of the minima).

#include <span>

#include "hil/base/result.h"

namespace forcegate {

struct DecayParameters {
  double a_V = 0, b_per_s = 0, c_V = 0;
  /// Standard errors that allow for autocorrelated residuals (maxima in the order of time): of the ordinary ones
  /// times the square root of the residuals' correlation time, and those from sums of scores over at most 20 blocks
  /// of neighbouring maxima, the set with the larger error of b.
  double u_a_V = 0, u_b_per_s = 0, u_c_V = 0;
  double rmse_V = 0;  ///< eq. (8)
  int n = 0;
};

/// t_s from the start of the excitation, maxima in volts, at least 6 points, b searched over
/// [1e-5, 1] 1/s on a logarithmic grid (variable projection: a and c are linear once b is given), then refined.
/// a may be negative (maxima that rise). Error (parse) when the maxima do not determine a decay: fewer than 6, not
/// finite, all equal, best b at an end of its range, or spanning less than 1/10 of the found 1/b.
Result<DecayParameters> fit_decay(std::span<const double> t_s, std::span<const double> maxima_V,
                                  double u_min_V);

/// A fitted decay over eq. (5) as printed (Lebosse 2011): b / (0.0019 f + 0.0056), (c/a) (1 + 1.377 A^2).
struct DecayScales {
  double b = 1.0, q = 1.0;
};
DecayScales scales_of(const DecayParameters& fit, double f_Hz, double A_N);

}  // namespace forcegate
