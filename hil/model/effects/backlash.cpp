// Backlash and guide friction: a play between wheel and trolley.  dF = sum_r c_r (P_r[L] - L), L the force of the
// linear rig law. F_ref against the angle shows a loop, U against F_ref none. A play takes force away while the spring closes; so does
// friction in front of the reference, and friction behind it adds to what it reads: strengths have either sign.

#include <algorithm>
#include <limits>

#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

constexpr double kRadii[] = {0.004, 0.01, 0.025, 0.06, 0.14};

struct Position {
  std::size_t record, row;
};

// The latest row before the record from which on the wheel has moved by both widths of the play: the state since then does not depend on
// any earlier one. The first row of all where it never has.
Position determined_from(const CampaignInput& c, std::size_t record, double radius) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  Position out{record, 0};
  for (std::size_t k = record; k-- > 0;)
    for (std::size_t i = c.records[k].rig_force_N.size(); i-- > 0;) {
      low = std::min(low, c.records[k].rig_force_N[i]);
      high = std::max(high, c.records[k].rig_force_N[i]);
      out = {k, i};
      if (high - low > 2.0 * radius) return out;
    }
  return out;
}

// The rig stays as the record before left it; before the first one it came from below.
double state_before(const CampaignInput& c, const RecordInput& r, double radius) {
  const Position from = determined_from(c, r.index, radius);
  if (from.record == r.index) return r.rig_force_N[0] - radius;
  Play play(radius, c.records[from.record].rig_force_N[from.row] - radius);
  double state = 0.0;
  for (std::size_t k = from.record; k < r.index; ++k)
    for (std::size_t i = k == from.record ? from.row : 0; i < c.records[k].rig_force_N.size(); ++i) state = play.step(c.records[k].rig_force_N[i]);
  return state;
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
    .needs = {"witness"},
    .forms = {{.name = "play_bank",
               .shape = {},
               .strength = {{"w1", "1", -2.0, 2.0, 0.0, "radius 0.4 % of the span"},
                            {"w2", "1", -2.0, 2.0, 0.0, "radius 1 %"},
                            {"w3", "1", -2.0, 2.0, 0.0, "radius 2.5 %"},
                            {"w4", "1", -2.0, 2.0, 0.0, "radius 6 %"},
                            {"w5", "1", -2.0, 2.0, 0.0, "radius 14 %"}},
               .sign = StrengthSign::either,
               .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; },
               .columns =
                   [](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
                     out.setZero();
                     if (r.rig_force_N.empty()) return;
                     for (int k = 0; k < 5; ++k) {
                       const double radius = kRadii[k] * c.range_N;
                       Play play(radius, state_before(c, r, radius));
                       for (std::size_t i = 0; i < r.rows(); ++i)
                         out(static_cast<Eigen::Index>(i), k) =
                             play.step(r.rig_force_N[i]) - r.rig_force_N[i];
                     }
                   },
               .singles = true,
               .bank = true}}}};

}  // namespace
}  // namespace forcegate
