#include "hil/diagnose/base/own_decay.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "hil/diagnose/base/base_fit.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kRows = 4000;

}  // namespace

OwnDecay own_decay(const RecordInput& r, const std::vector<std::size_t>& rows) {
  constexpr int kRates = 14;
  OwnDecay best;
  best.mean_square = 1e300;
  const double longest = std::max(1.0, r.duration_s - r.onset_s);
  for (int step = 0; step < kRates; ++step) {
    const double rate =
        std::exp(std::log(0.3 / longest) + step * (std::log(0.3) - std::log(0.3 / longest)) / (kRates - 1));
    Eigen::Matrix4d M = Eigen::Matrix4d::Zero();
    for (const std::size_t i : rows) {
      const double since = std::max(0.0, r.t_s[i] - r.onset_s);
      const Eigen::Vector4d x(1.0, r.F_N[i], std::expm1(-rate * since) * (r.F_N[i] - r.F_min_N), r.U_V[i]);
      M += x * x.transpose();
    }
    const double n = std::max<double>(1.0, static_cast<double>(rows.size()));
    if (step == 0) {
      const Eigen::Vector2d c = M.topLeftCorner<2, 2>().ldlt().solve(M.topRightCorner<2, 1>());
      best.static_mean_square = std::max(0.0, M(3, 3) - c.dot(M.topRightCorner<2, 1>())) / n;
    }
    const Eigen::Vector3d c = M.topLeftCorner<3, 3>().ldlt().solve(M.topRightCorner<3, 1>());
    const double mean_square = std::max(0.0, M(3, 3) - c.dot(M.topRightCorner<3, 1>())) / n;
    const double depth = c[1] != 0.0 ? c[2] / c[1] : 0.0;
    if (!(depth > 0.0 && depth < 1.1) || mean_square >= best.mean_square) continue;
    best.mean_square = mean_square;
    best.rate_per_s = rate;
    best.depth = std::min(depth, 0.99);
  }
  return best;
}

bool OwnDecay::is_decay() const {
  constexpr double kExplains = 0.6;
  return mean_square < (1.0 - kExplains) * static_mean_square && depth > 0.03;
}

bool decays_by_itself(const RecordInput& record) {
  return own_decay(record, choose_rows(record, kRows)).is_decay();
}

double left_by_decay(const RecordInput& record) {
  return own_decay(record, choose_rows(record, kRows)).mean_square;
}

}  // namespace forcegate::diagnose
