#pragma once
// Linear mixed model over records on Gram matrices (Laird and Ware 1982):
//
//   y_i = Z_i (beta + zeta_i) + S_i c + e_i,   zeta_i ~ N(0, diag sigma^2),  c_j ~ N(m_j, tau_j^2),  e_i ~ N(0, s_i^2)
//
// A gain of a record, column 0 of Z, multiplies the whole output of the sensor, and so what some columns of S add to it too: zeta_i0 goes
// with Z_i0 + h_i = (beta_0 Z_i0 + sum_j c_j S_ij) / g at the strengths of the iteration before (first-order conditional linearisation,
// Lindstrom and Bates 1990), g the slope of that on Z_0 over all records: a bank of plays may have most of the force. The fixed part goes
// with Z_i0 alone. So does a column that is a gain itself, x_i Z_i0 in every record (a temperature's): it goes with x_i (Z_i0 + h_i), x_i by
// regression of the column on Z_i0 and one.
//
// The first `n_fixed` columns of Z have a fixed part beta as well. The variances sigma^2 (spread between records) and
// s_i^2 (what the model leaves) are estimated by EM from the records themselves with weak priors; every fit re-estimates
// them, so that an effect that explains the scatter between records is paid for it. Each record counts for n_eff
// samples, not n: residuals are autocorrelated. All rows enter through Z'Z, Z'S, S'S, Z'y, S'y, y'y only.

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace forcegate::diagnose {

struct VarianceComponent {
  std::string name;
  double start_sd = 0.1;  ///< where EM begins: generous, it shrinks fast and grows slowly
  double prior_sd =
      0.01;  ///< weak prior: as if `prior_weight` records had shown this spread. Small on purpose:
  double prior_weight =
      0.5;  ///< the records can raise it by any factor, but cannot talk down a prior that is wide
  bool nuisance = false;  ///< a left-out record takes its fixed part as uncertain as the others leave it: no effect is judged by it
  bool told_by_all = false;  ///< a nuisance that stays as all records tell it when one is left out: no part of what that tests, and in records
                             ///< that hardly show it the form of an effect would bend it
};

/// A variance that is set instead of estimated: a record has nothing of its own there, nor of what its law is uncertain by.
inline constexpr double kHeldVariance = 1e-14;

/// Which records enter the sums of a fit. Effects are chosen on all of them: by the chain rule that is the evidence of
/// the fit records times the predictive density of the held-out ones. Parameters that are reported come from fit
/// records alone.
enum class RecordUse { fit_records, all_records };

/// What a record counts for at most: evidence within records is only a scale, n counts records.
inline constexpr double kMostSamples = 150.0;
/// Samples that `rows` count for: neighbours hang together over about five.
inline double effective_samples(std::size_t rows) {
  constexpr double kRowsOfASample = 5.0;
  return std::clamp(static_cast<double>(rows) / kRowsOfASample, 1.0, kMostSamples);
}

struct RecordGram {
  std::string name;
  Eigen::MatrixXd gram;  ///< (nz + ns + 1)^2, means over rows; the last column is y
  double n_eff = 1.0;
  double noise_variance = 0.0;  ///< white noise: s_i^2 is not estimated below this
  double allowed_variance =
      0.0;  ///< what the declared instruments may leave, steps of the reference included
  double smoothed_variance = 0.0;  ///< the noise that smoothing leaves in the reference: it hangs together and is no structure
  bool heldout = false;
};

/// How a column of S goes together with the gain of a record.
enum class GrowsWithGain : char {
  never,    ///< stands by itself: a voltage, a zero
  with_it,  ///< what the gain multiplies
  is_gain   ///< differs between records, as a gain or as a zero
};

struct MixedProblem {
  int nz = 0, n_fixed = 0, ns = 0;
  std::vector<int> component_of_z;
  std::vector<VarianceComponent> components;
  Eigen::VectorXd fixed_prior_sd;   ///< n_fixed
  Eigen::VectorXd plain_prior_sd = {};  ///< n_fixed: what a record is foretold by where nothing of its own is known; empty: fixed_prior_sd
  Eigen::VectorXd column_prior_sd;  ///< ns
  Eigen::VectorXd column_prior_mean = {};  ///< ns, or empty: all 0
  std::vector<GrowsWithGain> grows_with_gain = {};  ///< ns, or empty: none does
  std::vector<RecordGram> records;
  std::vector<Eigen::VectorXd>
      other_y;  ///< per record: replaces the last column of its Gram matrix (sign flips)

  int y_index() const { return nz + ns; }
};

struct MixedFit {
  std::vector<int> columns;  ///< which of S
  double log_evidence = -1e300;
  Eigen::VectorXd coefficient;  ///< beta, then c
  Eigen::MatrixXd covariance;
  Eigen::VectorXd variance;  ///< of each component
  Eigen::VectorXd per_gain;  ///< of each coefficient: what a unit of a record's gain adds to it, beside 1 to the first (h); empty: nothing
  std::vector<double> gain;  ///< of each record beside beta_0: zeta_0 and what columns that are gains have in it
  // per record, held-out ones too (predicted: their rows never enter the sums, and their zeta may go as far as the fixed parts are uncertain)
  std::vector<double> s2, adapted,
      plain;  ///< residual variance; mean square residual with and without zeta_i
  std::vector<Eigen::VectorXd> zeta;
  RecordUse use = RecordUse::fit_records;
  bool valid = false;

  /// Coefficients in a record, its own zeta set aside.
  Eigen::VectorXd coefficients(std::size_t record) const {
    return per_gain.size() > 0 ? Eigen::VectorXd(coefficient + gain[record] * per_gain) : coefficient;
  }
  /// Where a column of S stands among the coefficients; nothing where the fit does not have it.
  std::optional<Eigen::Index> place_of(int column) const {
    const auto at = std::ranges::find(columns, column);
    return at == columns.end() ? std::nullopt : std::optional<Eigen::Index>(coefficient.size() - (columns.end() - at));
  }
  /// Strength of a column of S and its standard error; 0 where the fit does not have it.
  double strength_of(int column) const {
    const auto at = place_of(column);
    return at ? coefficient[*at] : 0.0;
  }
  double standard_error_of(int column) const {
    const auto at = place_of(column);
    return at ? std::sqrt(std::max(0.0, covariance(*at, *at))) : 0.0;
  }
  Eigen::VectorXd strengths_of(const std::vector<int>& columns) const;
  bool counts(const RecordGram& record) const { return use == RecordUse::all_records || !record.heldout; }
};

/// Fits the columns. `warm`, of the same columns or others, gives the variances to start from; `iterations` of EM.
MixedFit fit_mixed(const MixedProblem& problem, const std::vector<int>& columns,
                   const MixedFit* warm = nullptr, int iterations = 12,
                   RecordUse use = RecordUse::fit_records);

/// The problem with the residual of `fit` turned over in some records: y* = X beta + sign (y - X beta). What an effect
/// still gains there is chance (Freedman and Lane 1983). Gram matrices are not copied back.
void flip_residuals(MixedProblem& problem, const MixedFit& fit, const std::vector<int>& sign);

/// Mean square adapted residual of every record of the fit when its own rows are kept from beta and c (leave one record
/// out); records outside the fit as they were.
struct LeftOut {
  std::vector<double> adapted, plain;  ///< with and without the record's own zeta
};
/// `freedom`: adapted errors let the record's zeta follow within the variances of this fit instead; two models are compared
/// at the same freedom.
LeftOut leave_one_out(const MixedProblem& problem, const MixedFit& fit, const MixedFit* freedom = nullptr);

/// How much the strength of some columns differs from record to record, relative to the strength itself: with lambda_i the
/// factor by which record i alone would multiply their contribution, and w_i its information,
/// h^2 = (sum w_i (lambda_i - 1)^2 - n) / sum w_i (Cochran 1954). A law has the same strength in every record.
double strength_scatter(const MixedProblem& problem, const MixedFit& fit, const std::vector<int>& columns);

/// The fit with `zeta` and `adapted` of every record of the problem at the variances of `freedom`; its coefficients as they were.
MixedFit at_freedom_of(const MixedProblem& problem, MixedFit fit, const MixedFit& freedom);

/// Adapted mean square residual of every record at the coefficients of `fit` and the variances of `freedom`.
std::vector<double> adapted_errors(const MixedProblem& problem, const MixedFit& fit, const MixedFit& freedom);

}  // namespace forcegate::diagnose
