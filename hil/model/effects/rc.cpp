// Parasitic RC: the sensor's own resistance R(F) ~ 1/F with a capacitance makes a pole that is slower at low load.
//   y' = (F - y) / (tau R(F) C / (Rm Cm)),  R(F) ~ 1/(F + Fe),  dU = g D c (y - F);  m: at mid force.
// Fe, in shares of the span, is what conducts without a load: next to nothing of the film alone, the other resistor of a divider beside it.
// load_dependent_pole: C of cable or filter, the same at every force. measured_capacitance: C(F) as recorded (C_F); since it
// grows with the force, the tail shortens less with the load.
// Paredes-Madrid et al. 2010: sensor = R(F) parallel C(F).

#include <algorithm>

#include "hil/model/capacitance_curve.h"
#include "hil/model/effect.h"
#include "hil/model/load_dependent_pole.h"

namespace forcegate {
namespace {

constexpr double kFilmAlone = 0.02, kOnDivider = 0.3;  // shares of the span

EffectForm form(const char* name, bool measured) {
  return {.name = name,
          .shape = {{"tau_s", "s", 1e-4, 10.0, 0.02, "time constant at mid force"},
                    {"unloaded", "1", 0.005, kUnloadedOfLayers, kFilmAlone, "what conducts without a load, share of the span: more of it is a lag"}},
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
                if (!measured) return load_dependent_pole(c, r, shape[0], shape[1], out, [](double) { return 1.0; });
                const auto curve = capacitance_curve(c);
                if (!curve) return;
                const double middle_F = curve->at_F(c.lowest_N + 0.5 * c.range_N), least = 0.1;
                load_dependent_pole(c, r, shape[0], shape[1], out,
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
