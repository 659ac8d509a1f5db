// Parasitic RC: the sensor's own resistance R(F) ~ 1/F with a capacitance makes a pole that is slower at low load.
//   y' = (F - y) / (tau R(F) C / (Rm Cm)),  R(F) ~ 1/(F + Fe),  dU = g D c (y - F);  m: at mid force.
// Fe, in shares of the span, is what conducts without a load: next to nothing of the film alone, the other resistor of a divider beside it.
// load_dependent_pole: C of cable or filter, the same at every force. measured_capacitance: C(F) as recorded (C_F); since it
// grows with the force, the tail shortens less with the load.
// Paredes-Madrid et al. 2010: sensor = R(F) parallel C(F).

#include <cmath>

#include "hil/model/capacitance_curve.h"
#include "hil/model/effect.h"
#include "hil/model/fading_memory.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

constexpr double kFilmAlone = 0.02, kOnDivider = 0.3;  // shares of the span

// 1 - e^-h. Below a quarter by Pade's quotient, 4e-6 off at most: the step stands in the innermost loop of all.
double decayed(double h) { return h < 0.25 ? h / (1.0 + h * (0.5 + h / 12.0)) : h * mean_of_decay(h); }

// `factor(F)`: C(F) / C(Fm).
template <class Factor>
void pole_columns(const CampaignInput& c, const RecordInput& r, double tau_s, double unloaded, ColumnsRef out,
                  const Factor& factor) {
  const double zero_N = c.no_load_N(), floor = unloaded * c.range_N, middle = c.lowest_N - zero_N + 0.5 * c.range_N + floor;
  const double per_Ns = 1.0 / (tau_s * middle);
  double y = r.fast_F_N[0];
  const auto time_constants = [&](std::uint32_t k) {
    const double F = r.fast_F_N[k];
    return (std::max(F - zero_N, 0.0) + floor) * per_Ns / factor(F) * (r.fast_t_s[k] - r.fast_t_s[k - 1]);
  };
  filter_wanted_rows(
      r,
      [&](std::uint32_t next, std::uint32_t k) {
        for (double h = 0.0; k > next && h < kForgotten; --k) h += time_constants(k);
        return k;
      },
      [&](std::uint32_t k) { return y = r.fast_F_N[k]; },
      [&](std::uint32_t k) { return y += (0.5 * (r.fast_F_N[k] + r.fast_F_N[k - 1]) - y) * decayed(time_constants(k)); },
      [&](std::size_t i, double mean) { out(static_cast<Eigen::Index>(i), 0) = r.decay[i] * (mean - r.F_N[i]); });
}

EffectForm form(const char* name, bool measured) {
  return {.name = name,
          .shape = {{"tau_s", "s", 1e-4, 10.0, 0.02, "time constant at mid force"},
                    {"unloaded", "1", 0.005, 0.3, kFilmAlone, "what conducts without a load, share of the span: more of it is a lag"}},
          .strength = {{"c", "1", -2.0, 2.0, 0.0, "share of the signal behind the pole"}},
          .sign = StrengthSign::positive,
          .grid = [measured](const CampaignInput& c) -> std::vector<std::vector<double>> {
            if (measured && !capacitance_curve(c)) return {};
            if (c.no_load_N() < 0.0) return {};  // nobody knows at which force the film conducts nothing
            std::vector<std::vector<double>> out;
            for (const double tau_s : {0.003, 0.008, 0.02, 0.05, 0.12}) {
              out.push_back({tau_s, kFilmAlone});
              if (!measured) out.push_back({tau_s, kOnDivider});
            }
            return out;
          },
          .columns =
              [measured](const CampaignInput& c, const RecordInput& r, std::span<const double> shape,
                         ColumnsRef out) {
                out.setZero();
                if (r.fast_F_N.empty()) return;
                if (!measured) return pole_columns(c, r, shape[0], shape[1], out, [](double) { return 1.0; });
                const auto curve = capacitance_curve(c);
                if (!curve) return;
                const double middle_F = curve->at_F(c.lowest_N + 0.5 * c.range_N), least = 0.1;
                pole_columns(c, r, shape[0], shape[1], out,
                             [&](double F) { return std::max(least, curve->at_F(F) / middle_F); });
              },
          .least = 0.0,
          .most = 1.2};
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "rc",
    .side = "instrument",
    .summary = "the output lags with a tail that is longer at low load",
    .equation = "y' = (F - y)(F + Fe)/(tau Fm) Cm/C(F), dU = g D c (y - F)",
    .source = "Paredes-Madrid et al. 2010",
    .look_alikes = {"lag", "delay", "piezocapacitance"},
    .separates = "steps of equal height at low and at high mean load, with the capacitance channel recorded",
    .needs = {},
    .traits = {.timing = true, .shift = TimeShift::first_shape},
    .forms = {form("load_dependent_pole", false), form("measured_capacitance", true)}}};

}  // namespace
}  // namespace forcegate
