#include "hil/model/spindle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "hil/trace/static_line.h"

namespace forcegate {
namespace {

struct AgainstAngle {
  bool moves = false;
  double turned_rad = 0.0;
  double variance_N2 = 0.0, left_by_spindle_N2 = 0.0, left_by_wheel_N2 = 0.0;
};

double left_N2(const StaticLine& line) {
  const double c = line.covariance_VN();
  return line.variance_V2() > 0.0 ? std::max(0.0, line.variance_N2() - c * c / line.variance_V2()) : line.variance_N2();
}

// Rows of a closed contact: where it is open the force stands at zero whatever the angle does.
AgainstAngle against_angle(const CampaignInput& c, const RecordInput& r) {
  constexpr double kClosed = 0.02, kMoves = 0.02;  // of the span
  constexpr double kFewestRows = 50.0;
  AgainstAngle out;
  if (r.theta_rad.size() != r.rows() || r.cos_theta.size() != r.rows()) return out;
  StaticLine of_angle, of_cosine;
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    if (r.ok[i] == 0 || !std::isfinite(r.theta_rad[i]) || r.F_N[i] < c.lowest_N + kClosed * c.range_N) continue;
    of_angle.push(r.theta_rad[i], r.F_N[i]);
    of_cosine.push(r.cos_theta[i], r.F_N[i]);
    low = std::min(low, r.theta_rad[i]), high = std::max(high, r.theta_rad[i]);
  }
  if (of_angle.n() < kFewestRows) return out;
  out.moves = of_angle.variance_N2() > kMoves * kMoves * c.range_N * c.range_N;
  out.turned_rad = high - low;
  out.variance_N2 = of_angle.variance_N2();
  out.left_by_spindle_N2 = left_N2(of_angle);
  out.left_by_wheel_N2 = left_N2(of_cosine);
  return out;
}

}  // namespace

bool is_spindle(const CampaignInput& campaign) {
  constexpr double kOfLine = 0.1, kOfWheel = 0.5;  // of the variance; of what the wheel leaves
  // a sine over 1.5 rad about its steepest place leaves six times as much of a line, whatever the wheel's zero is
  constexpr double kStraight = 1e-4, kPlainly = 0.02, kFewest_rad = 1.5;
  double turned_rad = 0.0;
  std::size_t move = 0, go_with_angle = 0, straight = 0;
  for (const RecordInput& r : campaign.records) {
    if (std::isfinite(r.eccentricity_mm)) return false;
    const AgainstAngle a = against_angle(campaign, r);
    if (!a.moves) continue;
    ++move;
    if (a.left_by_spindle_N2 > kOfLine * a.variance_N2 || a.left_by_spindle_N2 > kOfWheel * a.left_by_wheel_N2) continue;
    ++go_with_angle;
    turned_rad = std::max(turned_rad, a.turned_rad);
    straight += a.turned_rad > kFewest_rad && a.left_by_spindle_N2 < kStraight * a.variance_N2 && a.left_by_spindle_N2 < kPlainly * a.left_by_wheel_N2 ? 1 : 0;
  }
  return (turned_rad > std::numbers::pi && 2 * go_with_angle > move) || 2 * straight > move;
}

void take_spindle(CampaignInput& campaign) {
  if (!campaign.has_theta || !is_spindle(campaign)) return;
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (RecordInput& r : campaign.records) {
    for (const double theta : r.theta_rad) low = std::fmin(low, theta), high = std::fmax(high, theta);
    r.sin_theta.clear(), r.cos_theta.clear(), r.late_cos_theta.clear();
  }
  campaign.has_theta = false;
  campaign.has_spindle = true;
  campaign.notes.push_back(fmt::format("the force goes with the angle itself, over {:.2g} turns: it is read as the way of a spindle (F = a + k theta), not as the angle of a wheel",
                                       (high - low) / (2.0 * std::numbers::pi)));
}

}  // namespace forcegate
