#include "hil/model/load_dependent_pole.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/model/rows.h"

namespace forcegate {
namespace {

constexpr double kStep_s = 0.01, kRange_N = 4.0;

// A swing whose samples are far apart beside the pole; every row is one sample.
RecordInput swing() {
  RecordInput r;
  for (std::uint32_t k = 0; k < 400; ++k) {
    r.fast_t_s.push_back(kStep_s * k);
    r.fast_F_N.push_back(2.0 + 1.6 * std::sin(2.0 * M_PI * kStep_s * k));
    r.row_begin.push_back(k);
  }
  r.row_begin.push_back(400);
  r.t_s = r.fast_t_s;
  r.F_N = r.fast_F_N;
  r.decay.assign(400, 1.0);
  set_rates(r);
  return r;
}

Eigen::VectorXd lag_N(const RecordInput& r, double tau_s, double unloaded) {
  CampaignInput c;
  c.range_N = kRange_N;
  c.lowest_N = 0.0;
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(r.rows()), 1);
  load_dependent_pole(c, r, tau_s, unloaded, out, [](double) { return 1.0; });
  return out.col(0);
}

// y = F - tau(F) F' of a pole that is far quicker than a sample, and no half of a sample late.
TEST(LoadDependentPole, FarShorterThanASampleLagsByItsOwnTime) {
  const RecordInput r = swing();
  for (const double tau_s : {0.0003, 0.001}) {
    const Eigen::VectorXd lag = lag_N(r, tau_s, 0.3);
    for (std::size_t k = 10; k < r.rows(); ++k) {
      const double before = r.F_N[k - 1], slope = (r.F_N[k] - before) / kStep_s;
      const double here_s = tau_s * (0.5 + 0.3) * kRange_N / (before + 0.3 * kRange_N);
      EXPECT_NEAR(lag[static_cast<Eigen::Index>(k)], -here_s * slope, 0.05 * here_s * 10.0) << tau_s << " at " << k;
    }
  }
}

// What conducts without a load far above the range: the time constant is the same everywhere.
TEST(LoadDependentPole, BesideALargeConductanceIsThePoleOfOneTimeConstant) {
  const RecordInput r = swing();
  for (const double tau_s : {0.001, 0.02, 0.2}) {
    const Eigen::VectorXd lag = lag_N(r, tau_s, 1e6);
    const std::vector<double> exact = low_pass_rows(r, tau_s);
    for (std::size_t k = 10; k < r.rows(); ++k) EXPECT_NEAR(lag[static_cast<Eigen::Index>(k)], exact[k] - r.F_N[k], 1e-4) << tau_s << " at " << k;
  }
}

}  // namespace
}  // namespace forcegate
