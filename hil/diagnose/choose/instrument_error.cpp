#include "hil/diagnose/choose/instrument_error.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hil/diagnose/base/some_columns.h"
#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

namespace {

using Eigen::VectorXd;

constexpr int kPlaces = 6;
constexpr double kGolden = 0.6180339887498949;  // multiples of it are spread evenly over the step

// The error of a rounded force on every row, multiplied into the columns `A` of the record.
VectorXd rounded(const RecordGram& g, const Eigen::MatrixXd& A, double place) {
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

// Z, the columns `of_S` and y.
std::vector<int> columns_of_rows(const MixedProblem& problem, const std::vector<int>& of_S) {
  std::vector<int> out(static_cast<std::size_t>(problem.nz));
  std::iota(out.begin(), out.end(), 0);
  for (const int j : of_S) out.push_back(problem.nz + j);
  out.push_back(problem.y_index());
  return out;
}

}  // namespace

double removed_from_steps(const ResidualChannel& channel, const MixedFit& base, const EffectKind& kind) {
  std::vector<int> used = base.columns;
  std::vector<const Variant*> variants;
  for (const Variant& v : channel.variants)
    if (channel.candidates[static_cast<std::size_t>(v.candidate)].kind == &kind) {
      variants.push_back(&v);
      add_columns(used, v.columns);
    }
  MixedProblem problem = with_columns(channel.problem, used);
  problem.other_y.resize(problem.records.size());
  const std::vector<int> of_rows = columns_of_rows(channel.problem, used);
  std::vector<Eigen::MatrixXd> rows;
  for (std::size_t k = 0; k < problem.records.size(); ++k) rows.emplace_back(channel.rows[k].matrix(Eigen::all, of_rows));
  std::vector<int> of_base(base.columns.size());  // the first ones of those used
  std::iota(of_base.begin(), of_base.end(), 0);
  const MixedFit start = with_columns(base, used);
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
    for (std::size_t k = 0; k < problem.records.size(); ++k) problem.other_y[k] = rounded(problem.records[k], rows[k], kGolden * place);
    // at the variances of the model that is judged: no EM
    const MixedFit without = fit_mixed(problem, of_base, &start, 1, base.use);
    if (!without.valid) continue;
    const double all = mean(without);
    double most = 0.0;
    for (const Variant* v : variants) {
      std::vector<int> columns = of_base;
      for (const int j : v->columns) add_columns(columns, {static_cast<int>(std::ranges::find(used, j) - used.begin())});
      const MixedFit with = fit_mixed(problem, columns, &start, 1, base.use);
      if (with.valid) most = std::max(most, all - mean(with));
    }
    sum += most;
  }
  return std::sqrt(sum / kPlaces);
}

}  // namespace forcegate::diagnose
