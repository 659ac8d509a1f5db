#include "hil/diagnose/answer/shape_covariance.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hil/diagnose/base/some_columns.h"

namespace forcegate::diagnose {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double root_of_diagonal(const MatrixXd& m, Index at) { return std::sqrt(std::max(0.0, m(at, at))); }

// One column more behind those of S.
void append(MixedProblem& problem, std::size_t record, const VectorXd& cross, double square) {
  MatrixXd& G = problem.records[record].gram;
  const Index n = G.rows(), y = n - 1;
  MatrixXd wider(n + 1, n + 1);
  wider.topLeftCorner(y, y) = G.topLeftCorner(y, y);
  wider.col(n).head(y) = G.col(y).head(y);
  wider(n, n) = G(y, y);
  wider.col(y).head(y) = cross.head(y);
  wider(y, y) = square;
  wider(y, n) = cross(y);
  wider.triangularView<Eigen::StrictlyLower>() = wider.transpose();
  G = std::move(wider);
}

}  // namespace

VectorXd shape_derivative(const CampaignInput& campaign, const ResidualChannel& channel, const MixedFit& fit, const ShapeCovariance::Shape& shape,
                          const RecordInput& record) {
  constexpr double kRelative = 0.03, kOfRange = 1e-3;
  const Candidate& candidate = candidate_of(channel, shape.variant);
  const ParameterSpec& spec = candidate.form->shape[shape.index];
  const double at = candidate.shape[shape.index], step = at != 0.0 ? kRelative * std::abs(at) : kOfRange * (spec.maximum - spec.minimum);
  const double low = std::max(spec.minimum, at - step), high = std::min(spec.maximum, at + step);
  const auto rows = static_cast<Index>(record.rows());
  if (!(high > low)) return VectorXd::Zero(rows);
  VectorXd strength = VectorXd::Zero(candidate.count);
  for (const int column : columns_of(channel, shape.variant)) strength[column - candidate.first] = fit.strength_of(column);
  const auto contribution = [&](double value) -> VectorXd {
    std::vector<double> moved = candidate.shape;
    moved[shape.index] = value;
    MatrixXd columns = MatrixXd::Zero(rows, candidate.count);
    candidate.form->columns(campaign, record, moved, columns);
    return columns * strength;
  };
  const VectorXd slope = (contribution(high) - contribution(low)) / (high - low);
  return slope.unaryExpr([](double v) { return std::isfinite(v) ? v : 0.0; });
}

double ShapeCovariance::of_coefficient(Index at) const { return root_of_diagonal(covariance, at); }

double ShapeCovariance::of_shape(int variant, std::size_t index) const {
  const auto it = std::ranges::find_if(shapes, [&](const Shape& s) { return s.variant == variant && s.index == index; });
  return it == shapes.end() ? 0.0 : root_of_diagonal(covariance, covariance.rows() - static_cast<Index>(shapes.end() - it));
}

ShapeCovariance shape_covariance(const CampaignInput& campaign, const ResidualChannel& channel, const MixedFit& fit, const std::vector<int>& variants) {
  ShapeCovariance out{fit.covariance, {}, {}};
  std::vector<double> known;
  for (const int v : variants) {
    const Candidate& c = candidate_of(channel, v);
    for (std::size_t k = 0; c.form->refine && k < c.shape.size(); ++k)
      if (const ParameterSpec& spec = c.form->shape[k]; !spec.choice) {
        out.shapes.push_back({v, k});
        known.push_back(spec.maximum - spec.minimum);
      }
  }
  if (out.shapes.empty()) return out;

  MixedProblem problem = with_columns(channel.problem, fit.columns);
  std::vector<Index> of_fit;
  for (int j = 0; j < channel.problem.nz; ++j) of_fit.push_back(j);
  for (const int j : fit.columns) of_fit.push_back(channel.problem.nz + j);
  of_fit.push_back(channel.problem.y_index());
  std::vector<VectorXd> derivatives(out.shapes.size());
  std::size_t recording = 0;
  for (std::size_t k = 0; k < problem.records.size(); ++k) {
    // blocks of one recording read the columns of its first block
    const RecordInput& record = campaign.records[channel.record_of[k]];
    if (record.recording != recording || k == 0)
      for (std::size_t s = 0; s < out.shapes.size(); ++s) derivatives[s] = shape_derivative(campaign, channel, fit, out.shapes[s], record);
    recording = record.recording;
    const MatrixXd& A = channel.rows[k].matrix;
    const double n = std::max<double>(1.0, static_cast<double>(A.rows()));
    MatrixXd with = A(Eigen::all, of_fit);
    for (const VectorXd& derivative : derivatives) {
      const VectorXd column = channel.column_factor * derivative(channel.rows[k].row);
      append(problem, k, with.transpose() * column / n, column.squaredNorm() / n);
      MatrixXd wider(with.rows(), with.cols() + 1);
      wider << with.leftCols(with.cols() - 1), column, with.rightCols(1);
      with = std::move(wider);
    }
  }
  std::vector<int> columns(fit.columns.size() + out.shapes.size());
  std::iota(columns.begin(), columns.end(), 0);
  problem.ns = static_cast<int>(columns.size());
  problem.column_prior_sd.conservativeResize(problem.ns);
  problem.column_prior_mean.resize(0);  // of the covariance alone, which has no part in it
  for (std::size_t s = 0; s < known.size(); ++s) problem.column_prior_sd[static_cast<Index>(fit.columns.size() + s)] = known[s];
  if (!problem.grows_with_gain.empty()) problem.grows_with_gain.resize(columns.size(), GrowsWithGain::never);
  MixedFit start = fit;
  std::iota(start.columns.begin(), start.columns.end(), 0);
  const MixedFit joint = fit_mixed(problem, columns, &start, 1, fit.use);
  if (joint.valid) {
    out.covariance = joint.covariance;
    out.step = joint.coefficient.tail(static_cast<Index>(out.shapes.size()));
  } else {
    out.shapes.clear();
  }
  return out;
}

}  // namespace forcegate::diagnose
