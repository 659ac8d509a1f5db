// Piezo-capacitance: displacement current d(C V)/dt leads the force, tau0 = 10 ms, m: at mid force.
//   load_dependent:        dU = g c tau0 dF/dt 2 / (1 + F/Fm): C grows less and less with the force
//   fading:                dU = g c tau0 dF/dt ((1 + F/F0)/(1 + Fm/F0))^-p behind a pole of the amplifier: C(F) as a root (p = 2/3, F0 small), a
//                          logarithm (p = 1) or a saturation (p = 2)
//   measured_capacitance:  dU = g c tau0 dC/dt / C'(Fm), C(F) as recorded (C_F)
// (A lead without the load factor cannot be told from a reference that is late.) Hundreds of pF at 50 to 250 N (Paredes-Madrid et al. 2010).

#include <cmath>

#include "hil/model/capacitance_curve.h"
#include "hil/model/effect.h"
#include "hil/model/fading_memory.h"
#include "hil/model/states.h"
#include "hil/model/time_scale.h"

namespace forcegate {
namespace {

constexpr double kLead_s = 0.01;     // of one unit of strength
constexpr double kFollow_s = 0.005;  // bandwidth of the derivative
constexpr double kNoLag = 0.0;       // of whatever sensor: one that lags more at low load has a pole there (rc)

void assumed_columns(const CampaignInput& c, const RecordInput& r, ColumnsRef out) {
  const double zero_N = c.no_load_N(), middle = c.lowest_N - zero_N + 0.5 * c.range_N;
  const auto y = low_pass_rows(r, kFollow_s);
  r.for_each_wanted([&](std::size_t i) {
    out(static_cast<Eigen::Index>(i), 0) =
        2.0 * (r.F_N[i] - y[i]) * (2.0 / (1.0 + std::max(r.F_N[i] - zero_N, 0.0) / middle));
  });
}

// The charge moved by a step is C(after) - C(before), up and down alike: the derivative is that of C(F) at full rate.
void measured_columns(const CampaignInput& c, const RecordInput& r, const CapacitanceCurve& curve,
                      ColumnsRef out) {
  if (r.fast_F_N.empty()) return;
  const double slope = curve.slope_F_per_N(c.lowest_N + 0.5 * c.range_N);
  const auto charge = [&](std::uint32_t k) { return curve.at_F(r.fast_F_N[k]) / slope; };
  double q = charge(0), y = q;
  filter_wanted_rows(
      r, [&](std::uint32_t next, std::uint32_t begin) { return first_felt(r, kForgotten * kFollow_s, next, begin); },
      [&](std::uint32_t k) {
        y = q = charge(k);
        return 0.0;
      },
      [&](std::uint32_t k) {
        const double before = q;
        q = charge(k);
        const double middle = 0.5 * (before + q);
        y = middle + (y - middle) * std::exp(-(r.fast_t_s[k] - r.fast_t_s[k - 1]) / kFollow_s);
        return q - y;
      },
      [&](std::size_t i, double mean) { out(static_cast<Eigen::Index>(i), 0) = 2.0 * mean; });
}

EffectForm fading() {
  return {.name = "fading",
          .shape = {{"fade", "1", 0.005, 0.6, 0.2, "F0, share of the force span"},
                    {"power", "1", 0.3, 3.0, 1.0, "p"},
                    {"follow_s", "s", 5e-5, 0.05, kFollow_s, "pole of the amplifier"}},
          .strength = {{"c", "1", -50.0, 50.0, 0.0, "lead at mid force in units of 10 ms"}},
          .sign = StrengthSign::positive,
          .grid =
              [](const CampaignInput& c) {
                constexpr double kUsualRow_s = 0.02;
                std::vector<std::vector<double>> out;
                for (const double scale : time_scales(c, kUsualRow_s))
                  for (const double fade : {0.03, 0.12, 0.5})
                    for (const double power : {1.0, 2.0}) out.push_back({fade, power, scale * kFollow_s});
                return out;
              },
          .columns =
              [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                const double F0 = shape[0] * c.range_N, middle = c.lowest_N + 0.5 * c.range_N, at_middle = 1.0 + std::max(middle, 0.0) / F0;
                const auto y = low_pass_rows(r, shape[2]);
                r.for_each_wanted([&](std::size_t i) {
                  out(static_cast<Eigen::Index>(i), 0) =
                      kLead_s / shape[2] * (r.F_N[i] - y[i]) * std::pow((1.0 + std::max(r.F_N[i], 0.0) / F0) / at_middle, -shape[1]);
                });
              },
          .least = kNoLag};
}

EffectForm form(const char* name, bool measured) {
  return {
      .name = name,
      .shape = {},
      .strength = {{"c", "1", -50.0, 50.0, 0.0, "lead in units of 10 ms"}},
      .sign = StrengthSign::positive,
      .grid = [measured](const CampaignInput& c) -> std::vector<std::vector<double>> {
        if (measured && !capacitance_curve(c)) return {};
        return {{}};
      },
      .columns =
          [measured](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
            if (!measured) return assumed_columns(c, r, out);
            out.setZero();
            if (const auto curve = capacitance_curve(c)) measured_columns(c, r, *curve, out);
          },
      .least = kNoLag};
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "piezocapacitance",
    .side = "sensor",
    .summary = "the output leads the force on every edge, more at low load",
    .equation = "dU = g c tau0 dC(F)/dt / C'(Fm)",
    .source = "Paredes-Madrid et al. 2010",
    .look_alikes = {"delay", "rc", "lag"},
    .separates = "edges of equal height at low and high load, with the capacitance channel recorded",
    .needs = {},
    .traits = {.timing = true, .shift = TimeShift::percent_lead, .known_form = true},
    .forms = {form("load_dependent", false), fading(), form("measured_capacitance", true)}}};

}  // namespace
}  // namespace forcegate
