#include "hil/diagnose/answer/moving_zero.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "hil/diagnose/answer/findings.h"

namespace forcegate::diagnose {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Sums of a part: over its base force W, one, and what the effects leave of the output.
struct Part {
  double n = 0.0, W = 0.0, WW = 0.0, y = 0.0, Wy = 0.0, yy = 0.0;
};

std::vector<Part> parts_of(const ResidualChannel& channel, const MixedFit& fit) {
  const MixedProblem& p = channel.problem;
  std::vector<Part> out;
  for (const RecordRows& rows : channel.rows) {
    VectorXd y = rows.matrix.col(p.y_index());
    for (Index j = 2; j < p.n_fixed; ++j) y -= rows.matrix.col(j) * fit.coefficient[j];
    for (const int column : fit.columns) y -= rows.matrix.col(p.nz + column) * fit.strength_of(column);
    const auto W = rows.matrix.col(0);
    out.push_back({static_cast<double>(y.size()), W.sum(), W.squaredNorm(), y.sum(), W.dot(y), y.squaredNorm()});
  }
  return out;
}

enum class Own { nothing, zero, gain };

struct Line {
  double left = 0.0;  // mean square
  VectorXd own;       // of each part
};

// Mean square that a line of its own leaves in every part.
double left_by_own_lines(const std::vector<Part>& parts) {
  double square = 0.0, rows = 0.0;
  for (const Part& s : parts) {
    const double WW = s.WW - s.W * s.W / s.n, Wy = s.Wy - s.W * s.y / s.n;
    square += s.yy - s.y * s.y / s.n - (WW > 0.0 ? Wy * Wy / WW : 0.0);
    rows += s.n;
  }
  return std::max(0.0, square) / std::max(1.0, rows);
}

// Least squares of a line through all parts, of which each may have its own zero or gain.
Line line_through(const std::vector<Part>& parts, Own own) {
  const auto n = static_cast<Index>(parts.size());
  const Index columns = own == Own::nothing ? 2 : 1 + n;
  MatrixXd M = MatrixXd::Zero(columns, columns);
  VectorXd b = VectorXd::Zero(columns);
  double square = 0.0, rows = 0.0;
  for (Index k = 0; k < n; ++k) {
    const Part& s = parts[static_cast<std::size_t>(k)];
    const Index own_column = own == Own::nothing ? 1 : 1 + k;
    const bool gains = own == Own::gain;  // the common column is then the zero
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
  return {std::max(0.0, square - x.dot(b)) / std::max(1.0, rows), own == Own::nothing ? VectorXd() : VectorXd(x.tail(n))};
}

}  // namespace

std::optional<Finding> listed_moving_zero(const Workspace& w, const Selection& selection, const std::vector<Finding>& findings) {
  constexpr double kListed = 0.4;
  constexpr double kOfNothing = 0.16, kOfGains = 0.35;  // of what one line, and lines with own gains, leave above what own lines leave
  constexpr double kLeast = 2e-3;                      // of the span
  constexpr std::size_t kFewestParts = 4;
  const EffectKind* drift = EffectRegistry::instance().find("reference_drift");
  const MixedFit& fit = selection.claimed.valid ? selection.claimed : selection.base;
  if (!w.input.single || !w.zero_wanders || !fit.valid || w.output.rows.size() < kFewestParts || drift == nullptr ||
      std::ranges::find(findings, drift->name, &Finding::effect) != findings.end())
    return std::nullopt;
  const std::vector<Part> parts = parts_of(w.output, fit);
  const Line zeros = line_through(parts, Own::zero);
  const double moved = zeros.own.maxCoeff() - zeros.own.minCoeff(), without = line_through(parts, Own::nothing).left;
  const double least = left_by_own_lines(parts), above = zeros.left - least;
  if (above > kOfNothing * (without - least) || above > kOfGains * (line_through(parts, Own::gain).left - least) || moved < kLeast) return std::nullopt;
  Finding out = finding_about(*drift, w.output);
  out.form = "within_recording";
  out.probability = kListed;
  out.side_witnessed = false;
  out.error_before = w.output.scale * std::sqrt(without);
  out.error_after = w.output.scale * std::sqrt(zeros.left);
  out.evidence = fmt::format("the zero moves by {:.3g} m{} over the recording, whatever the force; not claimed: without a third channel nothing says whether it is "
                             "that of the reference or the sensor's own; a rest without load before and after shows both",
                             1e3 * w.output.scale * moved, w.output.unit);
  return out;
}

}  // namespace forcegate::diagnose
