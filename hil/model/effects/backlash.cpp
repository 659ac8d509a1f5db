// Backlash and guide friction: a play between wheel and trolley.  dF = sum_r c_r (P_r[L] - L), L the force of the
// linear rig law. F_ref against the angle shows a loop, U against F_ref none. A play takes force away while the spring closes; so does
// friction in front of the reference, and friction behind it adds to what it reads: strengths have either sign. A gear has one play:
//   dF = c (P_r[L] - L), r told by the records.
// of_angle: the play lies between motor and wheel, where the angle is read before it (0.2 rad is a worn gear):
//   dF = c (L(P_d[th]) - L(th)) = c s (cos th - cos P_d[th]): widest where the spring moves fastest, nothing at the ends of its stroke.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "hil/model/effect.h"
#include "hil/model/fading_memory.h"
#include "hil/model/play.h"

namespace forcegate {
namespace {

constexpr double kRadii[] = {0.004, 0.01, 0.025, 0.06, 0.14};

void fill_play(const CampaignInput& c, const RecordInput& r, double radius_N, bool kept, Eigen::Index column, ColumnsRef out) {
  Play play = play_at_start(c, r, &RecordInput::rig_force_N, radius_N, -std::numeric_limits<double>::infinity(), kept);
  for (std::size_t i = 0; i < r.rows(); ++i) out(static_cast<Eigen::Index>(i), column) = play.step(r.rig_force_N[i]) - r.rig_force_N[i];
}

// Newtons of the rig's law for one of 1 - cos th; 0 where the angle hardly turns.
double newtons_per_cosine(const RecordInput& r) {
  constexpr double kLeastTurn = 0.05;
  const auto [low, high] = std::ranges::minmax_element(r.cos_theta);
  const auto of = [&](auto at) { return r.rig_force_N[static_cast<std::size_t>(at - r.cos_theta.begin())]; };
  return *high - *low > kLeastTurn ? (of(low) - of(high)) / (*high - *low) : 0.0;
}

// The wheel lags behind the motor by half the play, on the side from which it was driven last. Every recording begins driven upwards.
void fill_play_of_angle(const RecordInput& r, double half_rad, ColumnsRef out) {
  const double s = newtons_per_cosine(r);
  if (s == 0.0) return;
  double theta = std::atan2(r.sin_theta[0], r.cos_theta[0]);
  Play play(half_rad, theta - half_rad);
  bool known = false;
  step_to_wanted_rows(
      r,
      [&](std::size_t i) {
        const double turned = std::atan2(r.sin_theta[i], r.cos_theta[i]) - theta;
        known = std::isfinite(turned);
        if (!known) return;
        theta += std::remainder(turned, 2.0 * std::numbers::pi);
        play.step(theta);
      },
      [&](std::size_t i) {
        if (known) out(static_cast<Eigen::Index>(i), 0) = s * (std::cos(theta) - std::cos(play.state()));
      });
}

// So narrow a grid that the right play fits better than a bank of wrong ones before it is refined.
std::vector<std::vector<double>> grid_of_plays(const CampaignInput& c) {
  constexpr double kLeast = 0.004, kMost = 0.2, kRatio = 1.15;  // of the span
  std::vector<std::vector<double>> out;
  for (double radius = kLeast; radius < kMost; radius *= kRatio)
    for (const std::vector<double>& kept : kept_or_not(c)) out.push_back({radius * c.range_N, kept[0]});
  return out;
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "backlash",
    .side = "rig",
    .channel = EffectChannel::rig,
    .summary =
        "the force against the wheel has a loop of the same width at any speed, as from play or friction of the guide; the sensor is innocent",
    .equation = "F = L + sum_r c_r (P_r[L] - L)",
    .source = "play operator; linear guide with friction",
    .look_alikes = {"hysteresis", "motor"},
    .separates = "plot both loops: F_ref against angle and U against F_ref",
    .needs = {Need::witness},
    .forms = {{.name = "play_bank",
               .shape = {kPlayKept},
               .strength = {{"w1", "1", -2.0, 2.0, 0.0, "radius 0.4 % of the span"},
                            {"w2", "1", -2.0, 2.0, 0.0, "radius 1 %"},
                            {"w3", "1", -2.0, 2.0, 0.0, "radius 2.5 %"},
                            {"w4", "1", -2.0, 2.0, 0.0, "radius 6 %"},
                            {"w5", "1", -2.0, 2.0, 0.0, "radius 14 %"}},
               .sign = StrengthSign::either,
               .grid = kept_or_not,
               .columns =
                   [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                     out.setZero();
                     if (r.rig_force_N.empty()) return;
                     for (int k = 0; k < 5; ++k) fill_play(c, r, kRadii[k] * c.range_N, shape[0] != 0.0, k, out);
                   },
               .refine = false,
               .singles = true,
               .bank = true},
              {.name = "one_play",
               .shape = {{"radius_N", "N", 1e-4, 1e3, 0.1, "half the width of the play, in force"}, kPlayKept},
               .strength = {{"c", "1", -2.0, 2.0, 0.0, "share of the force that the play acts on"}},
               .sign = StrengthSign::either,
               .grid = grid_of_plays,
               .columns =
                   [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                     out.setZero();
                     if (!r.rig_force_N.empty()) fill_play(c, r, shape[0], shape[1] != 0.0, 0, out);
                   }},
              {.name = "of_angle",
               .shape = {{"half_rad", "rad", 1e-4, 1.0, 0.05, "half the play between motor and wheel"}},
               .strength = {{"c", "1", -2.0, 2.0, 0.0, "share of the force that the play acts on"}},
               .sign = StrengthSign::either,
               .grid =
                   [](const CampaignInput& c) {
                     if (!c.has_theta) return std::vector<std::vector<double>>{};
                     return std::vector<std::vector<double>>{{0.005}, {0.01}, {0.02}, {0.04}, {0.08}, {0.16}};
                   },
               .columns =
                   [](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                     out.setZero();
                     if (!r.rig_force_N.empty() && !r.cos_theta.empty()) fill_play_of_angle(r, shape[0], out);
                   }}}}};

}  // namespace
}  // namespace forcegate
