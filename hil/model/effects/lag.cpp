// Lag: the layers need time to seat, or an anti-alias filter stands in the chain.
//   tau y' + y = F (one pole), the same twice (two poles), or a slab into which the load diffuses:
//   modes tau / (2n+1)^2 with weights 8 / (pi^2 (2n+1)^2)                            dU = g D c (y - F)
// two_speeds (ours): one pole that is slower or faster while y falls, tau_s up and tau_s * ratio down: a film is pushed together by the load
// and parts by itself.
// FlexiForce settles with the bench in 70 ms, the FSR needs 210 ms (Lebosse 2011, fig. 5).
// sooner_under_load (ours): one pole whose time constant falls with the load (load_dependent_pole.h): pressed layers seat sooner.
// slow (ours): a system that follows within seconds or minutes. All of the input passes it: an output that follows at once and grows by a
// share creeps.

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "hil/model/effect.h"
#include "hil/model/fading_memory.h"
#include "hil/model/load_dependent_pole.h"
#include "hil/model/states.h"
#include "hil/model/time_scale.h"

namespace forcegate {
namespace {

enum class Kind { one_pole, two_poles, diffusive };

constexpr double kSlowest_s = 1000.0, kOfRecord = 0.125;

void fill(const RecordInput& r, double tau_s, Kind kind, ColumnsRef out) {
  std::vector<double> y(r.rows(), 0.0);
  if (kind == Kind::diffusive) {
    double total = 0.0;
    for (int n = 0; n < 4; ++n) {
      const double odd = 2.0 * n + 1.0, w = 8.0 / (std::numbers::pi * std::numbers::pi * odd * odd);
      const auto mode = low_pass_rows(r, tau_s / (odd * odd));
      for (std::size_t i = 0; i < y.size(); ++i) y[i] += w * mode[i];
      total += w;
    }
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += (1.0 - total) * r.F_N[i];
  } else {
    y = low_pass_rows(r, kind == Kind::one_pole ? tau_s : 0.5 * tau_s, kind == Kind::one_pole ? 1 : 2);
  }
  r.for_each_wanted([&](std::size_t i) { out(static_cast<Eigen::Index>(i), 0) = r.decay[i] * (y[i] - r.F_N[i]); });
}

// Of one step of the clock: y += old (x_before - y) + now (x - y), exact for an input that is linear between samples.
struct Pole {
  Pole(double tau_s, double dt_s) {
    const double h = dt_s / tau_s, mean = mean_of_decay(h);
    old = mean - (1.0 - h * mean);
    now = 1.0 - mean;
  }
  double old, now;
};

// Which way it goes is asked where the last sample stood: the firmware that undoes it must know before it has the force.
void fill_two_speeds(const RecordInput& r, double tau_s, double ratio, ColumnsRef out) {
  if (r.fast_F_N.empty()) return;
  double y = r.fast_F_N[0], dt_s = -1.0;
  Pole up(tau_s, 1.0), down(tau_s * ratio, 1.0);
  const double memory_s = kForgotten * tau_s * std::max(1.0, ratio);
  filter_wanted_rows(
      r, [&](std::uint32_t next, std::uint32_t begin) { return first_felt(r, memory_s, next, begin); },
      [&](std::uint32_t k) { return y = r.fast_F_N[k]; },
      [&](std::uint32_t k) {
        const double before = r.fast_F_N[k - 1], step_s = r.fast_t_s[k] - r.fast_t_s[k - 1];
        if (std::abs(step_s - dt_s) > 1e-9 * step_s) {
          dt_s = step_s;
          up = Pole(tau_s, dt_s);
          down = Pole(tau_s * ratio, dt_s);
        }
        const Pole& pole = before < y - kSettled * std::abs(y) ? down : up;
        return y += pole.old * (before - y) + pole.now * (r.fast_F_N[k] - y);
      },
      [&](std::size_t i, double mean) { out(static_cast<Eigen::Index>(i), 0) = r.decay[i] * (mean - r.F_N[i]); });
}

EffectForm two_speeds() {
  return {.name = "two_speeds",
          .shape = {{"tau_s", "s", 1e-4, 10.0, 0.05, "time constant while the output rises"},
                    {"ratio", "1", 0.1, 10.0, 1.0, "time constant while it falls over that while it rises"}},
          .strength = {{"c", "1", -2.0, 2.0, 0.0, "share of the force that passes the lag"}},
          .sign = StrengthSign::positive,
          .grid =
              [](const CampaignInput&) {
                std::vector<std::vector<double>> out;
                for (const double tau_s : {0.01, 0.04, 0.16})
                  for (const double ratio : {0.4, 2.5}) out.push_back({tau_s, ratio});
                return out;
              },
          .columns =
              [](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                out.setZero();
                fill_two_speeds(r, shape[0], shape[1], out);
              },
          .least = 0.0,
          .most = 1.15};
}

EffectForm sooner_under_load() {
  constexpr double kTypical = 1.0;
  return {.name = "sooner_under_load",
          .shape = {{"tau_s", "s", 1e-4, 10.0, 0.05, "time constant at mid force"},
                    {"unloaded", "1", kUnloadedOfLayers, 10.0, kTypical, "how little the load hastens it, share of the span: less of it is a pole of the film's resistance"}},
          .strength = {{"c", "1", -2.0, 2.0, 0.0, "share of the force that passes the lag"}},
          .sign = StrengthSign::positive,
          .grid =
              [](const CampaignInput& c) -> std::vector<std::vector<double>> {
                if (c.no_load_N() < 0.0) return {};  // nobody knows at which force nothing is pressed together
                std::vector<std::vector<double>> out;
                for (const double tau_s : {0.004, 0.012, 0.04, 0.12, 0.4}) out.push_back({tau_s, kTypical});
                return out;
              },
          .columns =
              [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                out.setZero();
                if (!r.fast_F_N.empty()) load_dependent_pole(c, r, shape[0], shape[1], out, [](double) { return 1.0; });
              },
          .least = 0.0,
          .most = 1.15};
}

constexpr double kUsualRow_s = 0.01;

EffectForm filtered(const char* name, Kind kind, const ParameterSpec& tau, double least, std::function<std::vector<std::vector<double>>(const CampaignInput&)> grid) {
  return {.name = name,
          .shape = {tau},
          .strength = {{"c", "1", -2.0, 2.0, 0.0, "share of the force that passes the lag"}},
          .sign = StrengthSign::positive,
          .grid = std::move(grid),
          .columns = [kind](const CampaignInput&, const RecordInput& r, std::span<const double> shape,
                            ColumnsRef out) { fill(r, shape[0], kind, out); },
          .least = least,
          .most = 1.15};
}

EffectForm form(const char* name, Kind kind, std::vector<double> taus) {
  return filtered(name, kind, {"tau_s", "s", 1e-6, kSlowest_s, 0.05, "time constant"}, 0.0, [taus = std::move(taus)](const CampaignInput& campaign) {
    std::vector<std::vector<double>> out;
    for (const double scale : time_scales(campaign, kUsualRow_s))
      for (const double tau : taus) out.push_back({tau * scale});
    return out;
  });
}

// A record must be several time constants long to tell that the output gets there.
EffectForm slow(const char* name, Kind kind) {
  constexpr double kWhole = 0.7;
  return filtered(name, kind, {"tau_s", "s", 0.1, kSlowest_s, 10.0, "time constant"}, kWhole, [](const CampaignInput& campaign) {
    std::vector<std::vector<double>> out;
    if (!campaign.undeclared || campaign.records.empty()) return out;
    const double longest_s = std::min(kSlowest_s, kOfRecord * campaign.records.front().duration_s);
    for (double tau_s = 1.024 * time_scales(campaign, kUsualRow_s).back(); tau_s < longest_s; tau_s *= 2.0) out.push_back({tau_s});
    return out;
  });
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "lag",
    .side = "sensor",
    .summary = "the output follows the force late, with a one-sided tail after every edge",
    .equation = "tau y' + y = F, dU = g D c (y - F); sooner_under_load: tau ~ 1/(F + Fe)",
    .source = "Lebosse et al. 2011, fig. 5",
    .look_alikes = {"delay", "rc", "hysteresis", "clock_skew"},
    .separates =
        "fast edges at 1 kHz and sines at two frequencies a decade apart: a lag attenuates, a delay does not",
    .needs = {},
    .traits = {.timing = true, .shift = TimeShift::first_shape, .late = true, .any_course = true},
    .forms = {form("one_pole", Kind::one_pole, {0.001, 0.002, 0.004, 0.008, 0.016, 0.032, 0.064, 0.128, 0.256, 0.512}),
              form("two_poles", Kind::two_poles, {0.002, 0.004, 0.008, 0.016, 0.032, 0.064, 0.128, 0.256, 0.512}),
              form("diffusive", Kind::diffusive, {0.001, 0.004, 0.016, 0.064, 0.256}), two_speeds(), sooner_under_load(),
              slow("slow", Kind::one_pole), slow("slow_two_poles", Kind::two_poles), slow("slow_diffusive", Kind::diffusive)}}};

}  // namespace
}  // namespace forcegate
