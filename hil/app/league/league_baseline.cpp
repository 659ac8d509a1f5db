#include "hil/app/league/league_baseline.h"

#include <cmath>

#include "hil/diagnose/answer/residual_map.h"

namespace forcegate {
namespace {

struct Winner {
  double r = 0.0;
  std::string effect = "none";
};

/// z of a two-sided test at 1 % shared among `tests`, from the upper tail's leading term.
double limit_z(double tests) {
  const double tail = 0.005 / std::max(1.0, tests);
  double z = 3.0;
  for (int i = 0; i < 20; ++i)
    z = std::sqrt(2.0 * std::log(1.0 / (tail * z * std::sqrt(2.0 * 3.14159265358979))));
  return z;
}

void look(const diagnose::ResidualChannel& channel, Winner& winner) {
  const diagnose::MixedFit base = diagnose::fit_mixed(channel.problem, {}, nullptr, 20);
  if (!base.valid) return;
  const auto residual = diagnose::residual_rows(channel, base);
  const Eigen::Index ns = channel.problem.ns, nz = channel.problem.nz;
  Eigen::VectorXd cross = Eigen::VectorXd::Zero(ns), square = Eigen::VectorXd::Zero(ns);
  double energy = 0.0, rows = 0.0;
  for (std::size_t k = 0; k < channel.rows.size(); ++k) {
    const Eigen::MatrixXd& m = channel.rows[k].matrix;
    if (channel.problem.records[k].heldout || m.rows() == 0) continue;
    Eigen::VectorXd e = Eigen::Map<const Eigen::VectorXd>(residual[k].data(), m.rows());
    e.array() -= e.mean();
    Eigen::MatrixXd S = m.middleCols(nz, ns);
    S.rowwise() -= S.colwise().mean().eval();
    cross += S.transpose() * e;
    square += S.colwise().squaredNorm().transpose();
    energy += e.squaredNorm();
    rows += static_cast<double>(m.rows());
  }
  if (!(energy > 0.0) || rows < 10.0) return;
  const double limit = limit_z(static_cast<double>(ns)) / std::sqrt(rows);
  for (const diagnose::Candidate& c : channel.candidates)
    for (int j = c.first; j < c.first + c.count; ++j) {
      const double r = square[j] > 0.0 ? std::abs(cross[j]) / std::sqrt(square[j] * energy) : 0.0;
      if (r > limit && r > winner.r) winner = {r, c.kind->name};
    }
}

}  // namespace

std::string largest_correlation(const diagnose::Workspace& workspace) {
  Winner winner;
  look(workspace.output, winner);
  if (workspace.has_rig) look(workspace.rig, winner);
  return winner.effect;
}

}  // namespace forcegate
