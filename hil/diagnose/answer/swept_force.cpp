#include "hil/diagnose/answer/swept_force.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Dense>

namespace forcegate::diagnose {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kFewest = 100;  // rows of a record

std::vector<double> cumulated(const VectorXd& x) {
  std::vector<double> out(1, 0.0);
  for (const double v : x) out.push_back(out.back() + v);
  return out;
}

// rad/s at every row, RMS of the rate over that of the force about its mean, in a twentieth of the rows on either side.
VectorXd frequency_of(const VectorXd& F, const VectorXd& rate) {
  const Index n = F.size(), side = std::max<Index>(10, n / 20);
  const std::vector<double> sum = cumulated(F), square = cumulated(F.array().square()), of_rate = cumulated(rate.array().square());
  VectorXd out(n);
  for (Index i = 0; i < n; ++i) {
    const auto from = static_cast<std::size_t>(std::max<Index>(0, i - side)), to = static_cast<std::size_t>(std::min(n, i + side + 1));
    const double rows = static_cast<double>(to - from), mean = (sum[to] - sum[from]) / rows;
    const double variance = (square[to] - square[from]) / rows - mean * mean;
    out[i] = variance > 0.0 ? std::sqrt(std::max(0.0, of_rate[to] - of_rate[from]) / rows / variance) : 0.0;
  }
  return out;
}

// t dF/dt, f dF/dt, dF/dt of a record, without what its gain and zero take of them.
MatrixXd shifts_of(const RecordInput& r) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (r.ok[i] != 0 && std::isfinite(r.F_N[i]) && std::isfinite(r.rate_N_per_s[i])) rows.push_back(i);
  if (rows.size() < kFewest) return {};
  const auto n = static_cast<Index>(rows.size());
  VectorXd F(n), rate(n), t(n);
  for (Index i = 0; i < n; ++i) {
    const std::size_t row = rows[static_cast<std::size_t>(i)];
    F[i] = r.F_N[row], rate[i] = r.rate_N_per_s[row], t[i] = r.t_s[row];
  }
  MatrixXd out(n, 3);
  out << t.cwiseProduct(rate), frequency_of(F, rate).cwiseProduct(rate), rate;
  MatrixXd level(n, 2);
  level << VectorXd::Ones(n), F;
  out -= level * level.colPivHouseholderQr().solve(out);
  return out;
}

}  // namespace

double time_as_frequency(const CampaignInput& campaign) {
  Eigen::Matrix3d G = Eigen::Matrix3d::Zero();
  for (const RecordInput& r : campaign.records)
    if (const MatrixXd x = shifts_of(r); x.size() > 0) G += x.transpose() * x;
  if (!(G(2, 2) > 0.0)) return 0.0;
  const double tt = G(0, 0) - G(0, 2) * G(0, 2) / G(2, 2), ff = G(1, 1) - G(1, 2) * G(1, 2) / G(2, 2), tf = G(0, 1) - G(0, 2) * G(1, 2) / G(2, 2);
  return tt > 0.0 && ff > 0.0 ? std::abs(tf) / std::sqrt(tt * ff) : 0.0;
}

}  // namespace forcegate::diagnose
