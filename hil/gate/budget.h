#pragma once
// Uncertainty of a mean relative error of extrema, in percentage points (k = 1). Systematic parts do not
// shrink with the number of extrema; random ones do.
//
//   ATI calibration   100 u_rel                      systematic
//   alignment         100 u_align                    systematic
//   drift             100 hypot(|zero| / F, |spring slope - 1|) / sqrt 3   systematic: what this record showed of it;
//                     this record's alone, so it does not cancel against a limit that was derived on other days
//   resolution        100 (r / sqrt 12) / (F sqrt n)   rectangular, random because the noise dithers it
//   noise             100 s / (F sqrt(2 h + 1) sqrt n)  s of one reading, mean of 2 h + 1 samples
//   synchronisation   100 (1 - cos(2 pi f u))         systematic; zero slope at an extremum; f of the swing that most extrema
//                     belong to; u^2 = u_lag^2 + u_time^2: of the lag as measured, and of a reading's time as the reference's
//                     adapter declares it
//   repeatability     standard error over the extrema  random

#include <string>
#include <vector>

#include "hil/gate/case_record.h"

namespace forcegate {

struct BudgetLine {
  std::string name;
  double u = 0.0;
  bool systematic = false;
  bool of_this_record = false;  ///< systematic, but in no derived limit
};

struct Budget {
  std::vector<BudgetLine> lines;
  double u() const;  ///< root of the sum of squares
  double u_systematic() const;
  /// Against a limit that was derived on the same rig: what is systematic cancels, unless it is of this record.
  double u_against_derived() const;
  double u_of_this_record() const;
  double u_of_readings() const;  ///< resolution and noise
  double u_of_scatter() const;   ///< repeatability
  /// Effective degrees of freedom of `of` (u() or u_against_derived()) where the repeatability is of n items: (n - 1) (of / u_repeatability)^4,
  /// Welch and Satterthwaite with all else known (JCGM 100, G.4). 0: many.
  double degrees_of_freedom(double of, std::size_t n) const;
  /// "ATI calibration 0.500, alignment 0.200, ... %"; `derived`: the parts of u_against_derived(), and which were left out.
  std::string to_text(const std::string& unit, bool derived) const;
};

/// `typical_N` is the mean expected extremum, `standard_error` in 1 (not %), n the number of extrema.
Budget mre_budget(const PlanUncertainty& plan, const CaseRecord& record, double typical_N,
                  double standard_error, std::size_t n, double half_width_s);

/// The same parts for a mean absolute error, in newtons; so is `standard_error_N`.
Budget mae_budget(const PlanUncertainty& plan, const CaseRecord& record, double typical_N,
                  double standard_error_N, std::size_t n, double half_width_s);

}  // namespace forcegate
