// Spring nonlinearity: k(x) grows as coils close.  dF = c2 L^2/R + c3 L^3/R^2, L the force of the linear rig law.
// The reference sees it: U against F_ref stays at its floor.

#include "hil/model/effect.h"

namespace forcegate {
namespace {

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "spring_nonlinearity",
    .side = "rig",
    .channel = EffectChannel::rig,
    .summary = "the spring's force against its compression is bent; the sensor is innocent",
    .equation = "F = L + c2 L^2/R + c3 L^3/R^2",
    .source = "compression spring with closing coils",
    .look_alikes = {"static_nonlinearity"},
    .separates = "a quasi-static turn of the wheel at full eccentricity: F_ref minus k x against x",
    .needs = {Need::witness},
    .forms = {{.name = "cubic",
               .shape = {},
               .strength = {{"c2", "1", -2.0, 2.0, 0.0, "quadratic part"},
                            {"c3", "1", -2.0, 2.0, 0.0, "cubic part"}},
               .sign = StrengthSign::either,
               .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; },
               .columns =
                   [](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
                     out.setZero();
                     if (r.rig_force_N.empty()) return;
                     r.for_each_wanted([&](std::size_t i) {
                       const double L = r.rig_force_N[i] / c.range_N;
                       out(static_cast<Eigen::Index>(i), 0) = L * L * c.range_N;
                       out(static_cast<Eigen::Index>(i), 1) = L * L * L * c.range_N;
                     });
                   },
               .singles = true,
               .bank = true}}}};

}  // namespace
}  // namespace forcegate
