#include "hil/model/capacitance_curve.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "hil/base/evenly_chosen.h"

namespace forcegate {
namespace {

constexpr std::size_t kRowsPerRecord = 500, kFewestRows = 100;

}  // namespace

double CapacitanceCurve::at_F(double force_N) const {
  const double x = (force_N - lowest_N) / range_N;
  return C0_F + x * (C1_F + x * C2_F);
}

double CapacitanceCurve::slope_F_per_N(double force_N) const {
  const double x = std::clamp((force_N - lowest_N) / range_N, 0.0, 1.0);
  return (C1_F + 2.0 * C2_F * x) / range_N;
}

std::optional<CapacitanceCurve> capacitance_curve(const CampaignInput& campaign) {
  if (!campaign.has_capacitance || !(campaign.range_N > 0.0)) return std::nullopt;
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  std::size_t n = 0;
  constexpr double kPico = 1e12;
  for (const RecordInput& r : campaign.records) {
    if (r.C_F.empty()) continue;
    EvenlyChosen choice(r.rows(), kRowsPerRecord);
    for (std::size_t i = 0; i < r.rows(); ++i) {
      if (r.ok[i] == 0 || !std::isfinite(r.C_F[i]) || !choice.next()) continue;
      const double x = (r.F_N[i] - campaign.lowest_N) / campaign.range_N;
      const Eigen::Vector3d row(1.0, x, x * x);
      A += row * row.transpose();
      b += row * (kPico * r.C_F[i]);
      ++n;
    }
  }
  if (n < kFewestRows) return std::nullopt;
  const Eigen::Vector3d c = A.ldlt().solve(b) / kPico;
  const CapacitanceCurve curve{campaign.lowest_N, campaign.range_N, c[0], c[1], c[2]};
  const double highest_N = campaign.lowest_N + campaign.range_N;
  const bool rises = curve.slope_F_per_N(campaign.lowest_N) > 0.0 && curve.slope_F_per_N(highest_N) > 0.0 &&
                     curve.at_F(campaign.lowest_N) > 0.0;
  return rises ? std::optional(curve) : std::nullopt;
}

}  // namespace forcegate
