// Slow recovery at rest: cycling charges a state x (0..1) that relaxes in about 2 h (Lebosse 2011, section III-D:
// static gain +7 % for FlexiForce, -11 % for FSR after 20 min).
//   x' = (1 - x)/tau_up while cycling, x' = -x/tau_rest otherwise.  dU = g c x W, or g c x (F - Fmin).
// by_travel (ours): x' = (1 - x) |F'| / (L R) - x/tau_rest, R the force range: what charges it is the load that comes and goes, whether the
// maxima decay meanwhile or not, and no record needs to be called cyclic.

#include <algorithm>
#include <cmath>

#include "hil/model/effect.h"
#include "hil/model/states.h"

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

// Exact for a load that travels `spans` at an even rate.
double after_travel(double x, double spans, double seconds, double spans_up, double rest_s) {
  const double charge = spans / spans_up, rate = charge + seconds / rest_s;
  return x + (charge - rate * x) * mean_of_decay(rate);
}

double travelled_at_start(const CampaignInput& c, const RecordInput& record, double spans_up, double rest_s) {
  double x = 0.0, clock_s = c.records.front().start_s;
  for (const RecordInput& r : c.records) {
    x = after_travel(x, 0.0, std::max(0.0, r.start_s - clock_s), spans_up, rest_s);
    if (r.index == record.index) break;
    x = after_travel(x, r.travel_N.empty() ? 0.0 : r.travel_N.back() / c.range_N, r.duration_s, spans_up, rest_s);
    clock_s = r.start_s + r.duration_s;
  }
  return x;
}

EffectForm by_travel() {
  return {.name = "by_travel",
          .shape = {{"spans_up", "1", 1.0, 1e6, 100.0, "travel of the load, in force ranges, that charges it to 63 %"},
                    {"tau_rest_s", "s", 30.0, 1e6, 3600.0, "time constant at rest"}},
          .strength = {{"c", "1", -2.0, 2.0, 0.0, "relative change of the output at full charge"}},
          .sign = StrengthSign::either,
          .grid =
              [](const CampaignInput& c) {
                std::vector<std::vector<double>> out;
                const double travelled = std::clamp(c.travel_total_N / c.range_N, 10.0, 1e6);
                for (const double share : {0.1, 0.5})
                  for (const double rest_s : {300.0, 1200.0, 4800.0}) out.push_back({share * travelled, rest_s});
                return out;
              },
          .columns =
              [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                double x = travelled_at_start(c, r, shape[0], shape[1]), t_s = 0.0, travel_N = 0.0;
                // what an earlier record left behind wears off while the decay of this one takes over
                if (r.dynamic)
                  return r.for_each_wanted([&](std::size_t i) {
                    const double carried = r.t_s[i] > r.onset_s ? r.decay[i] : 1.0;
                    out(static_cast<Eigen::Index>(i), 0) = x * std::exp(-r.t_s[i] / shape[1]) * carried * r.base_force_N(i);
                  });
                for (std::size_t i = 0; i < r.rows(); ++i) {
                  x = after_travel(x, (r.travel_N[i] - travel_N) / c.range_N, std::max(0.0, r.t_s[i] - t_s), shape[0], shape[1]);
                  t_s = r.t_s[i];
                  travel_N = r.travel_N[i];
                  out(static_cast<Eigen::Index>(i), 0) = x * r.base_force_N(i);
                }
              }};
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "slow_recovery",
    .side = "sensor",
    .summary = "a record starts with what the one before it left behind; it fades with hours of rest",
    .equation = "x' = (1 - x)/tau_up cycling, -x/tau_rest at rest, or (1 - x) |F'|/(L R) - x/tau_rest; dU = g c x W",
    .source = "Lebosse et al. 2011, section III-D",
    .look_alikes = {"wear", "thermal", "creep"},
    .separates = "the same ramp after 5, 20, 60 and 120 min of rest",
    .needs = {},
    .traits = {.between_records = true, .needs_records = true, .of_cycling = true},
    .forms = {form("gain", false, false), form("swing", true, false), form("carried_gain", false, true),
              form("carried_swing", true, true), by_travel()}}};

}  // namespace
}  // namespace forcegate
