#pragma once
// One record's share in a fit of the mixed model: its own zeta is integrated out of the columns C = [fixed part of Z,
// chosen S, y].
//
// A gain of the record goes with parts of other columns too (mixed_model.h); the fixed part of Z in C has none of them.
//
//   A = w Z'Z + diag 1/sigma^2 = L L',   X = L^-1 w Z'C,   marginal Gram matrix M = w C'C - X'X,   w = n_eff / s^2
//
// (Lindstrom and Bates 1988, eq. 2.4, on means over rows instead of rows.) L, X and L^-1 come from one elimination of
// the rows [A | w Z'C | I]. Columns of Z that the record does not excite are left out: their zeta keeps its prior.

#include <Eigen/Dense>
#include <vector>

#include "hil/diagnose/base/mixed_model.h"

namespace forcegate::diagnose {

/// What a record says of its own zeta at given coefficients.
struct Conditional {
  Eigen::VectorXd zeta, zeta_variance;  ///< nz
  double mean_square = 0.0;             ///< of the residual with zeta taken off
  double penalty = 0.0;                 ///< sum zeta_j^2 / sigma_j^2
  double trace = 0.0;                   ///< of Z'Z times the covariance of zeta
};

class RecordPart {
 public:
  RecordPart(const MixedProblem& problem, std::size_t record, const std::vector<int>& columns);

  /// MixedFit::per_gain; empty: a gain multiplies the law alone.
  void set_own_gain(const Eigen::VectorXd& per_gain);
  /// The record's gain beside that of all, with which the rest goes: its own, and that of the columns which are gains; 0 where nothing does.
  double gain(const Eigen::VectorXd& coefficient, double zeta_0) const;

  /// For the variances `sigma2` of all columns of Z and the weight w; before what follows.
  void eliminate(const Eigen::VectorXd& sigma2, double weight);

  /// Adds M to the lower triangle of `total`: columns() columns of at least rows_of_marginal() rows.
  void add_marginal(Eigen::MatrixXd& total) const;
  Eigen::MatrixXd marginal() const;
  Eigen::Index columns() const { return n_columns_; }
  Eigen::Index rows_of_marginal() const { return stride_; }

  /// Products of all columns of Z, as the record's own zeta goes with them, with each other (nz, nz) and with C (nz, columns());
  /// rows that the record does not excite are 0.
  Eigen::MatrixXd own_with_own() const;
  Eigen::MatrixXd own_with_columns() const;

  /// `v`: minus the coefficients, then 1.
  void condition(const Eigen::VectorXd& v, Conditional& out) const;
  /// ln |A| + sum ln sigma_j^2.
  double log_determinant() const;
  /// v' C'C v: mean square residual without zeta, never below 0.
  double plain(const Eigen::VectorXd& v) const;

 private:
  void find_gains(const MixedProblem& problem, const Eigen::MatrixXd& gram, const std::vector<int>& columns);

  std::vector<int> excited_;      // columns of Z
  Eigen::Index n_fixed_ = 0;      // columns of C that are of Z
  Eigen::Index n_z_ = 0;          // all columns of Z
  Eigen::Index n_columns_ = 0;    // of C
  Eigen::Index stride_ = 0;       // of C'C and of Z'C
  Eigen::Index identity_ = 0;     // where I begins in a row
  Eigen::Index width_ = 0;        // of a row
  std::vector<double> source_;    // rows [Z'Z | Z'C | 0]
  std::vector<double> rows_;      // the same after the elimination: [L' | X | L^-1]
  std::vector<double> gram_;      // C'C
  bool grows_ = false, has_gains_ = false;
  struct {
    std::vector<double> source, gram;
  } as_given_;                    // what will change when a gain goes with more than the law
  Eigen::VectorXd gain_;          // of C: by which it is a gain of the record; empty: nothing grows with it
  Eigen::VectorXd h_C_, h_Z_;     // what goes with a gain beside the law, with C and with Z
  Eigen::VectorXd sigma2_;        // of the excited columns
  double weight_ = 1.0;
};

}  // namespace forcegate::diagnose
