#include "hil/diagnose/between/record_regression.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "hil/diagnose/between/record_scatter.h"

namespace forcegate::diagnose {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Best {
  double log_evidence = -1e300, scatter = 0.0;
  RecordStructure more;
  double size = 0.0;
  MatrixXd covariance_of(const RecordSeries& series) const { return covariance(series, scatter, more); }
  // of each record by itself; what a session shares does not make one of its records count less than another
  VectorXd weight_of(const RecordSeries& series) const {
    RecordSeries own = series;
    own.alike.clear();
    return covariance(own, scatter, {.cyclic = more.cyclic}).diagonal().cwiseInverse();
  }
};

// Errors of records predicted from the others under a covariance, mu flat: (P y)_i / P_ii.
VectorXd left_out_errors(const RecordSeries& series, const MatrixXd& C) {
  const Index n = series.value.size();
  const MatrixXd inverse = C.llt().solve(MatrixXd::Identity(n, n));
  const VectorXd ones = inverse.rowwise().sum();
  const MatrixXd P = inverse - ones * ones.transpose() / ones.sum();
  return (P * series.value).cwiseQuotient(P.diagonal());
}

// 1 for records of which the others say something under a predictor whose strengths are free: the only one of its mounting has a column, or the
// mean, to itself (leverage 1). 0 for all where that leaves less than half of them.
VectorXd told_by_others(const RecordPredictor& p) {
  constexpr double kAlone = 0.999, kMost = 0.5;
  const Index n = p.column.rows();
  VectorXd out = VectorXd::Ones(n);
  if (p.weight.maxCoeff() != p.weight.minCoeff()) return out;
  MatrixXd X(n, p.column.cols() + 1);
  X << VectorXd::Ones(n), p.column;
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(X);
  const MatrixXd Q = qr.householderQ() * MatrixXd::Identity(n, qr.rank());
  for (Index i = 0; i < n; ++i)
    if (Q.row(i).squaredNorm() > kAlone) out[i] = 0.0;
  if (out.sum() < kMost * static_cast<double>(n)) out.setZero();
  return out;
}

// X'X and X'y of whitened columns, scaled by the roots of their prior variances.
struct CrossProducts {
  MatrixXd square;
  VectorXd with_y;
};
CrossProducts cross_products(const Whitened& white, Index first, const RecordPredictor& p) {
  const Index k = p.weight.size();
  const VectorXd root = p.weight.cwiseSqrt();
  const auto X = white.columns.middleCols(first, k);
  return {root.asDiagonal() * MatrixXd(X.transpose() * X) * root.asDiagonal(), root.cwiseProduct(X.transpose() * white.y)};
}

template <class Matrix, class Vector>
double log_bayes(const CrossProducts& cross, bool positive, double size) {
  Matrix M = size * size * cross.square;
  M.diagonal().array() += 1.0;
  const Eigen::LLT<Matrix> llt(M);
  const Vector b = size * cross.with_y, z = llt.matrixL().solve(b);
  const double both = 0.5 * z.squaredNorm() - llt.matrixLLT().diagonal().array().log().sum();
  return positive ? both + log_one_sided(b[0] / std::sqrt(M(0, 0))) : both;
}

// Of a few columns on the stack: steps at unknown places are many predictors.
double log_bayes(const CrossProducts& cross, bool positive, double size) {
  constexpr int kFew = 8;
  if (cross.with_y.size() > kFew) return log_bayes<MatrixXd, VectorXd>(cross, positive, size);
  return log_bayes<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kFew, kFew>, Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kFew, 1>>(cross, positive, size);
}

// Whether it stands beside sessions and courses, or is the best of its number of columns of those that do not.
bool leads(const std::vector<RecordPredictor>& predictors, const std::vector<RecordScore>& scores, std::size_t at) {
  if (!predictors[at].alone) return true;
  for (std::size_t v = 0; v < predictors.size(); ++v)
    if (predictors[v].alone && predictors[v].column.cols() == predictors[at].column.cols() && scores[v].gain > scores[at].gain) return false;
  return true;
}

}  // namespace

double log_mean_exp(const std::vector<double>& x) {
  if (x.empty()) return -1e300;
  LogSum sum;
  for (double v : x) sum.add(v);
  return sum.log() - std::log(static_cast<double>(x.size()));
}

double log_one_sided(double z) {
  constexpr double kFar = -30.0;  // the tail is 0 to a double below it
  return std::log(std::erfc(-std::max(z, kFar) / std::numbers::sqrt2));
}

double joint_gain(const std::vector<double>& gains) {
  if (gains.size() == 1) return gains.front();
  std::vector<double> all = gains;
  all.push_back(std::accumulate(gains.begin(), gains.end(), 0.0));
  return log_mean_exp(all);
}

double normalise(RecordPredictor& p) {
  const double n = static_cast<double>(p.column.rows());
  double square = 0.0, largest = 0.0;
  for (Index j = 0; j < p.column.cols(); ++j) {
    const VectorXd d = p.column.col(j).array() - p.column.col(j).mean();
    square += p.weight[j] * d.squaredNorm() / n;
    largest = std::max(largest, p.column.col(j).cwiseAbs().maxCoeff());
  }
  if (!(square > 1e-16 * largest * largest)) return 0.0;
  const double factor = 1.0 / std::sqrt(square);
  p.column *= factor;
  return factor;
}

std::vector<RecordScore> score_predictors(const RecordSeries& series, const std::vector<RecordPredictor>& predictors,
                                          const std::vector<double>& sizes) {
  std::vector<RecordScore> out(predictors.size());
  const Index n = series.value.size();
  if (n < kFewestRecords || predictors.empty()) return out;
  Index k = 0, beside = 0;  // columns of all; of those that have evidence beside sessions and courses, which stand first
  std::vector<Index> first(predictors.size());
  for (const bool alone : {false, true}) {
    for (std::size_t v = 0; v < predictors.size(); ++v)
      if (predictors[v].alone == alone) {
        first[v] = k;
        k += predictors[v].column.cols();
      }
    if (!alone) beside = k;
  }
  MatrixXd columns(n, k);
  for (std::size_t v = 0; v < predictors.size(); ++v) columns.middleCols(first[v], predictors[v].column.cols()) = predictors[v].column;

  LogSum null;
  Best best_null;
  std::vector<LogSum> with(predictors.size());
  std::vector<Best> best(predictors.size());
  for (const auto& [s, log_prior] : scatters(series))
    for (const RecordStructure& more : structures(series)) {
      const Whitened white = whiten(series, covariance(series, s, more), more.apart() ? columns : MatrixXd(columns.leftCols(beside)));
      const double prior = std::log(more.prior) + log_prior;
      const double spread = log_variance(s, more);
      null.add(white.log_null + prior, spread);
      if (white.log_null + prior > best_null.log_evidence) best_null = {white.log_null + prior, s, more, 0.0};
      for (std::size_t v = 0; v < predictors.size(); ++v) {
        if (predictors[v].alone && !more.apart()) continue;
        const CrossProducts cross = cross_products(white, first[v], predictors[v]);
        for (const double size : sizes) {
          const double e = white.log_null + prior + log_bayes(cross, predictors[v].positive, size);
          with[v].add(e, spread);
          if (e > best[v].log_evidence) best[v] = {e, s, more, size};
        }
      }
    }
  const VectorXd e0 = left_out_errors(series, best_null.covariance_of(series));
  for (std::size_t v = 0; v < predictors.size(); ++v) out[v].gain = with[v].log() - std::log(static_cast<double>(sizes.size())) - null.log();
  for (std::size_t v = 0; v < predictors.size(); ++v) {
    const RecordPredictor& p = predictors[v];
    if (!leads(predictors, out, v)) continue;
    out[v].explained = 1.0 - std::exp(with[v].mean() - null.mean());
    const MatrixXd K = best[v].size * best[v].size * p.column * p.weight.asDiagonal() * p.column.transpose();
    const MatrixXd C = best[v].covariance_of(series);
    const VectorXd e1 = left_out_errors(series, C + K);
    const VectorXd told = best[v].weight_of(series).cwiseProduct(told_by_others(p));
    out[v].left_out = told.sum() > 0.0 ? told.dot(e1.cwiseAbs2()) / std::max(1e-300, told.dot(e0.cwiseAbs2())) : 1.0;
    const VectorXd ones = VectorXd::Ones(n);
    const Eigen::LLT<MatrixXd> llt(C + K);
    const double mean = ones.dot(llt.solve(series.value)) / ones.dot(llt.solve(ones));
    const VectorXd added = K * llt.solve(VectorXd(series.value.array() - mean));
    out[v].added = added.array() - added.mean();
  }
  return out;
}

}  // namespace forcegate::diagnose
