// Slow recovery at rest: cycling charges a state x (0..1) that relaxes in about 2 h (Lebosse 2011, section III-D:
// static gain +7 % for FlexiForce, -11 % for FSR after 20 min).
//   x' = (1 - x)/tau_up while cycling, x' = -x/tau_rest otherwise.  dU = g c x W, or g c x (F - Fmin).

#include <cmath>

#include "hil/model/effect.h"

namespace forcegate {
namespace {

double relax(double x, bool cycling, double seconds, double up_s, double rest_s) {
  return cycling ? 1.0 - (1.0 - x) * std::exp(-seconds / up_s) : x * std::exp(-seconds / rest_s);
}

double state_at_start(const CampaignInput& c, const RecordInput& record, double up_s, double rest_s) {
  double x = 0.0, clock_s = 0.0;
  bool first = true;
  for (const RecordInput& r : c.records) {
    if (!first) x = relax(x, false, std::max(0.0, r.start_s - clock_s), up_s, rest_s);
    if (r.index == record.index) return x;
    x = relax(x, false, r.dynamic ? r.onset_s : r.duration_s, up_s, rest_s);
    if (r.dynamic) x = relax(x, true, r.duration_s - r.onset_s, up_s, rest_s);
    clock_s = r.start_s + r.duration_s;
    first = false;
  }
  return x;
}

EffectForm form(const char* name, bool swing_only, bool carried_only) {
  return {
      .name = name,
      .shape = {{"tau_up_s", "s", 1.0, 1e5, 300.0, "time constant while cycling"},
                {"tau_rest_s", "s", 1.0, 1e6, 3600.0, "time constant at rest"}},
      .strength = {{"c", "1", -2.0, 2.0, 0.0, "relative change of the output at full charge"}},
      .sign = StrengthSign::either,
      .grid =
          [](const CampaignInput&) {
            return std::vector<std::vector<double>>{
                {150.0, 900.0}, {150.0, 2700.0}, {150.0, 7200.0}, {600.0, 1500.0}, {600.0, 4500.0}};
          },
      .columns =
          [=](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
            const double up = shape[0], rest = shape[1], start = state_at_start(c, r, up, rest);
            r.for_each_wanted([&](std::size_t i) {
              const double t = r.t_s[i];
              double x = relax(start, false, r.dynamic ? std::min(t, r.onset_s) : t, up, rest);
              if (r.dynamic && t > r.onset_s && !carried_only) x = relax(x, true, t - r.onset_s, up, rest);
              // what an earlier record left behind wears off while the new decay takes over
              if (r.dynamic && t > r.onset_s && carried_only) x *= r.decay[i];
              const double force =
                  swing_only ? (r.dynamic ? r.F_N[i] - r.F_min_N : r.F_N[i]) : r.base_force_N(i);
              out(static_cast<Eigen::Index>(i), 0) = x * force;
            });
          }};
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "slow_recovery",
    .side = "sensor",
    .summary = "a record starts with what the one before it left behind; it fades with hours of rest",
    .equation = "x' = (1 - x)/tau_up cycling, -x/tau_rest at rest; dU = g c x W",
    .source = "Lebosse et al. 2011, section III-D",
    .look_alikes = {"wear", "thermal", "creep"},
    .separates = "the same ramp after 5, 20, 60 and 120 min of rest",
    .needs = {},
    .traits = {.between_records = true, .needs_records = true},
    .forms = {form("gain", false, false), form("swing", true, false), form("carried_gain", false, true),
              form("carried_swing", true, true)}}};

}  // namespace
}  // namespace forcegate
