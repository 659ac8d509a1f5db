#include "hil/diagnose/base/judge.h"

#include <utility>

namespace forcegate::diagnose {

double judged(const ResidualChannel& channel, const std::vector<double>& mean_square, JudgedBy by) {
  double sum = 0.0, n = 0.0;
  for (std::size_t i = 0; i < mean_square.size(); ++i)
    if (by != JudgedBy::heldout || channel.problem.records[i].heldout) {
      sum += mean_square[i];
      n += 1.0;
    }
  return n > 0.0 ? sum / n : 0.0;
}

Judged judge(const ResidualChannel& channel, const MixedFit& fit, const MixedFit& freedom, JudgedBy by) {
  if (by != JudgedBy::left_out)
    return {adapted_errors(channel.problem, fit, freedom), channel.problem.plain_prior_sd.size() > 0 ? leave_one_out(channel.problem, fit).plain : fit.plain};
  LeftOut out = leave_one_out(channel.problem, fit, &freedom);
  return {std::move(out.adapted), std::move(out.plain)};
}

MixedFit without_levels(const ResidualChannel& channel, MixedFit freedom) {
  for (std::size_t j = 0; j < 2; ++j) freedom.variance[channel.problem.component_of_z[j]] = kHeldVariance;
  return freedom;
}

std::vector<double> judge_levels(const ResidualChannel& channel, const MixedFit& fit, const MixedFit& freedom, JudgedBy by) {
  return judge(channel, fit, without_levels(channel, freedom), by).adapted;
}

std::vector<std::vector<double>> residual_rows(const ResidualChannel& channel, const MixedFit& fit) {
  std::vector<std::vector<double>> out;
  const MixedProblem& p = channel.problem;
  for (std::size_t k = 0; k < channel.rows.size(); ++k) {
    const auto& A = channel.rows[k].matrix;
    const Eigen::VectorXd coefficient = fit.coefficients(k);
    Eigen::VectorXd e = A.col(p.y_index()) - A.leftCols(p.nz) * fit.zeta[k] - A.leftCols(p.n_fixed) * coefficient.head(p.n_fixed);
    for (const int column : fit.columns) e -= A.col(p.nz + column) * coefficient[*fit.place_of(column)];
    e *= channel.scale;
    out.emplace_back(e.data(), e.data() + e.size());
  }
  return out;
}

}  // namespace forcegate::diagnose
