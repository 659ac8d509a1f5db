#pragma once
// What the levels of records scatter by beside their measurement: each by itself, with its session, along a course, and cyclic ones more. Shared by the score of
// a predictor and by the chance of orders; hil/diagnose/between/record_regression.h has the model.

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "hil/diagnose/between/record_regression.h"

namespace forcegate::diagnose {

/// Fewer say nothing.
inline constexpr Eigen::Index kFewestRecords = 4;

/// Variances beside that of every record, as multiples of it (k, l, w), and the prior of these.
struct RecordStructure {
  double session = 0.0, cyclic = 0.0, course = 0.0, prior = 1.0;
  double course_s = 0.0;  ///< over which time it changes
  bool smooth = false;    ///< the course has a slope everywhere; else it goes as a random walk does

  /// No more than every record by itself, and cyclic ones more.
  bool apart() const { return session == 0.0 && course == 0.0; }
};
std::vector<RecordStructure> structures(const RecordSeries& series);

/// A value of s, and ln of its prior up to a constant.
struct Scatter {
  double s, log_prior;
};
/// Even in ln s, from far below the spread of the values to beyond it.
std::vector<Scatter> scatters(const RecordSeries& series);

/// diag(v) + s^2 (I + k G + l H + w K + 1000 A), A_ij = 1 where i and j are RecordSeries::alike.
Eigen::MatrixXd covariance(const RecordSeries& series, double scatter, const RecordStructure& more);

/// ln of the variance of a record beside that of its measurement, its own, its session's and its course's: under the model without x these may hold what
/// x explains, and the scatter within sessions alone would not fall. What cyclic ones scatter more is that of their decay, which x need not explain.
double log_variance(double scatter, const RecordStructure& more);

/// ln det L of a lower triangle.
inline double half_log_det(const Eigen::MatrixXd& lower) { return lower.diagonal().array().log().sum(); }

/// Series and predictors under one covariance, the mean projected out.
struct Whitened {
  double log_null = 0.0;  ///< ln evidence without columns
  Eigen::VectorXd y;
  Eigen::MatrixXd columns;
};
Whitened whiten(const RecordSeries& series, const Eigen::MatrixXd& C, const Eigen::MatrixXd& columns);

/// ln of a sum of exponentials, and a mean weighted by them.
class LogSum {
 public:
  void add(double x, double value = 0.0) {
    if (x > top_) {
      const double shrink = std::exp(top_ - x);
      sum_ *= shrink;
      moment_ *= shrink;
      top_ = x;
    }
    sum_ += std::exp(x - top_);
    moment_ += std::exp(x - top_) * value;
  }
  double log() const { return top_ + std::log(sum_); }
  double mean() const { return moment_ / sum_; }

 private:
  double top_ = -1e300, sum_ = 0.0, moment_ = 0.0;
};

}  // namespace forcegate::diagnose
