#include "hil/diagnose/base/own_lines.h"

#include <algorithm>

namespace forcegate::diagnose {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

LineSums line_sums(const ResidualChannel& channel, const MixedFit& fit, std::size_t record, Index begin, Index end) {
  const MixedProblem& p = channel.problem;
  const auto rows = channel.rows[record].matrix.middleRows(begin, end - begin);
  VectorXd y = rows.col(p.y_index());
  for (Index j = 2; j < p.n_fixed; ++j) y -= rows.col(j) * fit.coefficient[j];
  for (const int column : fit.columns) y -= rows.col(p.nz + column) * fit.strength_of(column);
  const auto W = rows.col(0);
  return {static_cast<double>(y.size()), W.sum(), W.squaredNorm(), y.sum(), W.dot(y), y.squaredNorm()};
}

std::vector<LineSums> line_sums_of_records(const ResidualChannel& channel, const MixedFit& fit) {
  std::vector<LineSums> out;
  for (std::size_t k = 0; k < channel.rows.size(); ++k) out.push_back(line_sums(channel, fit, k, 0, channel.rows[k].matrix.rows()));
  return out;
}

double left_by_own_lines(const std::vector<LineSums>& parts) {
  double square = 0.0, rows = 0.0;
  for (const LineSums& s : parts) {
    const double WW = s.WW - s.W * s.W / s.n, Wy = s.Wy - s.W * s.y / s.n;
    square += s.yy - s.y * s.y / s.n - (WW > 0.0 ? Wy * Wy / WW : 0.0);
    rows += s.n;
  }
  return std::max(0.0, square) / std::max(1.0, rows);
}

LineThrough line_through(const std::vector<LineSums>& parts, OwnOfLine own) {
  const auto n = static_cast<Index>(parts.size());
  const Index columns = own == OwnOfLine::nothing ? 2 : 1 + n;
  MatrixXd M = MatrixXd::Zero(columns, columns);
  VectorXd b = VectorXd::Zero(columns);
  double square = 0.0, rows = 0.0;
  for (Index k = 0; k < n; ++k) {
    const LineSums& s = parts[static_cast<std::size_t>(k)];
    const Index own_column = own == OwnOfLine::nothing ? 1 : 1 + k;
    const bool gains = own == OwnOfLine::gain;  // the common column is then the zero
    M(0, 0) += gains ? s.n : s.WW;
    b[0] += gains ? s.y : s.Wy;
    M(own_column, own_column) += gains ? s.WW : s.n;
    b[own_column] += gains ? s.Wy : s.y;
    M(0, own_column) += s.W;
    M(own_column, 0) += s.W;
    square += s.yy, rows += s.n;
  }
  M.diagonal().array() += 1e-12 * (1.0 + M.diagonal().maxCoeff());
  const VectorXd x = M.ldlt().solve(b);
  return {std::max(0.0, square - x.dot(b)) / std::max(1.0, rows), own == OwnOfLine::nothing ? VectorXd() : VectorXd(x.tail(n))};
}

}  // namespace forcegate::diagnose
