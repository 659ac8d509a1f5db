#include "hil/diagnose/choose/instrument_error.h"

#include <algorithm>
#include <cmath>

namespace forcegate::diagnose {

namespace {

using Eigen::VectorXd;

constexpr int kPlaces = 6;
constexpr double kGolden = 0.6180339887498949;  // multiples of it are spread evenly over the step

// The error of a rounded force on every row, multiplied into all columns of the record.
VectorXd rounded(const ResidualChannel& channel, std::size_t k, double place) {
  const RecordGram& g = channel.problem.records[k];
  const Eigen::MatrixXd& A = channel.rows[k].matrix;
  VectorXd out = VectorXd::Zero(A.cols());
  const double step = std::sqrt(12.0 * std::max(0.0, g.allowed_variance - g.noise_variance));
  if (!(step > 0.0) || A.rows() == 0) return out;
  VectorXd error(A.rows());
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    const double at = A(i, 0) / step + place;  // column 0 is the force
    error[i] = step * (at - std::floor(at) - 0.5);
  }
  const double n = static_cast<double>(A.rows());
  out = A.transpose() * error / n;
  out[A.cols() - 1] = error.squaredNorm() / n;
  return out;
}

}  // namespace

double removed_from_steps(const ResidualChannel& channel, const MixedFit& base, const EffectKind& kind) {
  MixedProblem problem = channel.problem;
  problem.other_y.resize(problem.records.size());
  const auto mean = [&](const MixedFit& fit) {
    double sum = 0.0, n = 0.0;
    for (std::size_t k = 0; k < problem.records.size(); ++k)
      if (fit.counts(problem.records[k])) {
        sum += fit.adapted[k];
        n += 1.0;
      }
    return sum / std::max(1.0, n);
  };
  double sum = 0.0;
  for (int place = 0; place < kPlaces; ++place) {
    // the same in all records: a level that comes again is rounded as before
    for (std::size_t k = 0; k < problem.records.size(); ++k) problem.other_y[k] = rounded(channel, k, kGolden * place);
    // at the variances of the model that is judged: no EM
    const MixedFit without = fit_mixed(problem, base.columns, &base, 1, base.use);
    if (!without.valid) continue;
    const double all = mean(without);
    double most = 0.0;
    for (const Variant& v : channel.variants) {
      if (channel.candidates[static_cast<std::size_t>(v.candidate)].kind != &kind) continue;
      std::vector<int> columns = base.columns;
      for (const int j : v.columns)
        if (std::find(columns.begin(), columns.end(), j) == columns.end()) columns.push_back(j);
      const MixedFit with = fit_mixed(problem, columns, &base, 1, base.use);
      if (with.valid) most = std::max(most, all - mean(with));
    }
    sum += most;
  }
  return std::sqrt(sum / kPlaces);
}

}  // namespace forcegate::diagnose
