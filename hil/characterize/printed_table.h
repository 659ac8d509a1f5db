#pragma once
// Tables II and III of Lebosse 2011 as printed, and what can be learnt from Table II alone: how well eq. (5) fits it,
// what its records lose in 20 minutes, and whether a, b or c/a depend on something that eq. (5) leaves out.

#include <span>
#include <string>
#include <vector>

namespace forcegate::characterize {

struct PrintedRow {
  double f_Hz, A_N, m_N;
  double a_V, b_per_s, c_V, rmse_V;
};
std::span<const PrintedRow> printed_table_II();

/// Errors in % as printed: of the laws (5) on the sum of two sines f1, f2.
struct PrintedPair {
  double f1_Hz, f2_Hz, a_pct, b_pct, c_pct;
};
std::span<const PrintedPair> printed_table_III();

/// Mean |law / printed - 1| of eq. (5) on Table II, %; losses of the swing in 20 min by the printed parameters and by
/// the laws, %.
struct PrintedErrors {
  double a_pct = 0, b_pct = 0, c_pct = 0;
  double loss_printed_pct = 0, loss_laws_pct = 0;
};
PrintedErrors errors_on_printed_table();

/// One term added to one law: relative least squares on the 20 rows with and without it.
struct LeftOut {
  std::string parameter;                         ///< "a", "b", "c/a"
  std::string term;                              ///< "m", "f", "A", "ln f", "A/m" ...
  double coefficient = 0, se = 0;                ///< relative change per unit of the term
  double p = 1;                                  ///< two-sided, Student
  bool significant = false;                      ///< Holm at 5 % over all terms tried
  double loo_before_pct = 0, loo_after_pct = 0;  ///< mean relative leave-one-out error
};

/// Every candidate, in order of p.
std::vector<LeftOut> search_printed_table();

}  // namespace forcegate::characterize
