#include "rigs/emulated/hidden/detectability.h"

#include <Eigen/Dense>
#include <cmath>

#include "rigs/emulated/hidden/difference.h"

namespace forcegate::hidden {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Level {
  Eigen::Vector2d added = Eigen::Vector2d::Zero();        // relative gain, zero in V or N
  Eigen::Matrix2d open = Eigen::Matrix2d::Identity();     // covariance of these from the record's own noise
};

// Least squares of what the effect adds to one record on (without, 1). A rest tells a zero alone: its gain is as good as unknown.
Level level_of(const std::vector<double>& with, const std::vector<double>& without, double noise) {
  constexpr double kUnknownGain = 1e-4;  // information, 1 / relative gain^2
  Eigen::Matrix2d gram = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < with.size(); ++i) {
    const double d = with[i] - without[i];
    if (!std::isfinite(d)) continue;
    const Eigen::Vector2d x(without[i], 1.0);
    gram += x * x.transpose();
    right += d * x;
  }
  gram /= noise * noise;
  right /= noise * noise;
  gram(0, 0) += kUnknownGain;
  gram(1, 1) += kUnknownGain;
  Level out;
  out.open = gram.inverse();
  out.added = out.open * right;
  return out;
}

}  // namespace

double detectability_between(const std::vector<RecordData>& with, const std::vector<RecordData>& without, const Conditions& c,
                             Measure measure) {
  const auto n = static_cast<Index>(with.size());
  if (n < 3 || without.size() != with.size()) return 0.0;
  const bool voltage = measure == Measure::voltage;
  const double noise = voltage ? c.voltage_noise_V : std::hypot(c.reference_noise_N, c.reference_step_N / std::sqrt(12.0));
  const double offset_N = 0.01 * c.sd_offset_pct * 5.0;
  const double zero = voltage ? std::hypot(offset_N / c.gain_N_per_V, c.wander_V) : offset_N;
  const Eigen::Vector2d scatter(c.sd_gain * c.sd_gain, zero * zero);

  VectorXd added(2 * n);
  MatrixXd C = MatrixXd::Zero(2 * n, 2 * n), X = MatrixXd::Zero(2 * n, 2);
  for (Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Level level = level_of(column_of(with[k], measure), column_of(without[k], measure), noise);
    added.segment<2>(2 * i) = level.added;
    X.block<2, 2>(2 * i, 0).setIdentity();
    for (Index j = 0; j < n; ++j) {
      const bool one_session = with[k].plan.session_seed == with[static_cast<std::size_t>(j)].plan.session_seed;
      const double shared = (i == j ? 1.0 - c.session_share : 0.0) + (one_session ? c.session_share : 0.0);
      C.block<2, 2>(2 * i, 2 * j) += (shared * scatter).asDiagonal();
    }
    C.block<2, 2>(2 * i, 2 * i) += level.open;
  }
  const Eigen::LDLT<MatrixXd> of_C(C);
  const VectorXd weighed = of_C.solve(added);
  const VectorXd common = X.transpose() * weighed;
  const Eigen::Matrix2d known = X.transpose() * of_C.solve(X);
  return std::sqrt(std::max(0.0, added.dot(weighed) - common.dot(known.ldlt().solve(common))));
}

}  // namespace forcegate::hidden
