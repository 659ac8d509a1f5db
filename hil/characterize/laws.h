#pragma once
// The parameter-variation laws of Lebosse 2011, eq. (5), fitted again to the decays of a study, and their errors on
// records that they were, or were not, fitted to.
//
//   a = a2 A^2 + a1 A,   b = b1 f + b0,   c / a = 1 / (1 + k A^2)
//
// f in Hz: lowest frequency at the start; A in N: amplitude of the force; a, c in V; b in 1/s.

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "hil/characterize/session.h"

namespace forcegate::characterize {

struct Laws {
  double a2_V_per_N2 = 0.884, a1_V_per_N = 0.865;  ///< the values are those that the paper prints
  double b1_s_per_s = 0.0019, b0_per_s = 0.0056;
  double k_per_N2 = 1.377;
  /// Standard errors: jackknife over specimens (records of one specimen are not independent). NaN: not estimated.
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  double se_a2 = kUnknown, se_a1 = kUnknown, se_b1 = kUnknown, se_b0 = kUnknown, se_k = kUnknown;
  std::size_t records = 0, specimens = 0;

  double a_V(double A_N) const { return (a2_V_per_N2 * A_N + a1_V_per_N) * A_N; }
  double b_per_s(double f_Hz) const { return b1_s_per_s * f_Hz + b0_per_s; }
  double ratio(double A_N) const { return 1.0 / (1.0 + k_per_N2 * A_N * A_N); }
};

/// Least squares over all fitted records of the set; records[i] belongs to specimen[i]. Error (parse) with fewer than
/// three records or one amplitude only.
Result<Laws> fit_laws(std::span<const DecayRecord> records, std::span<const std::string> specimen);

/// Relative errors of the laws on one record, %: of a, b, c, and eq. (9): mean of |U_fit - U_model| / U_fit over the
/// record, where U_fit is the exponential fitted to the maxima and U_model = U_min by eq. (4) + a e^(-bt) + c by the laws.
struct LawErrors {
  double a_pct = 0, b_pct = 0, c_pct = 0, mre_pct = 0;
};
LawErrors errors_of_laws(const Laws& laws, const DecayRecord& record, const Calibration& calibration);

/// Means over the records of a set for one group of specimens; the spread is the standard deviation of the specimens'
/// means.
struct LawScore {
  std::string set;    ///< DecayRecord::set
  std::string group;  ///< "identification" or "validation": on which specimens
  LawErrors mean, sd;
  std::size_t specimens = 0, records = 0, left_out = 0;  ///< left_out: eq. (3) could not be fitted
};

struct LawStudy {
  Laws fitted;
  bool available = false;  ///< false: nothing to fit them to
  std::string why_not;
  std::vector<LawScore> scores;
};

/// Fits on the specimens of `identification` (set "series") and scores every set on both groups.
LawStudy study_laws(std::span<const SessionSheet> sheets, const std::vector<std::string>& identification);

}  // namespace forcegate::characterize
