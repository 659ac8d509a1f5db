// Piezo-capacitance: displacement current d(C V)/dt leads the force.  dU = g c tau0 dF/dt / (1 + F/Fm), tau0 = 10 ms.
// (A lead without the load factor cannot be told from a reference that is late.) Hundreds of pF at 50 to 250 N (Paredes-Madrid et al. 2010).

#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

EffectForm form(const char* name, bool loaded) {
  return {.name = name,
          .shape = {},
          .strength = {{"c", "1", -50.0, 50.0, 0.0, "lead in units of 10 ms"}},
          .sign = StrengthSign::positive,
          .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; },
          .columns = [loaded](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
            const double middle = c.lowest_N + 0.5 * c.range_N;
            const auto y = low_pass_rows(r, 0.005);
            for (std::size_t i = 0; i < r.rows(); ++i)
              out(static_cast<Eigen::Index>(i), 0) =
                  2.0 * (r.F_N[i] - y[i]) * (loaded ? 2.0 / (1.0 + std::max(r.F_N[i], 0.0) / middle) : 1.0);
          }};
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "piezocapacitance",
    .side = "sensor",
    .summary = "the output leads the force on every edge, more at low load",
    .equation = "dU = g c tau0 dF/dt / (1 + F/Fm)",
    .source = "Paredes-Madrid et al. 2010",
    .look_alikes = {"delay", "rc", "lag"},
    .separates = "edges of equal height at low and high load, with the capacitance channel recorded",
    .needs = {},
    .forms = {form("load_dependent", true)}}};

}  // namespace
}  // namespace forcegate
