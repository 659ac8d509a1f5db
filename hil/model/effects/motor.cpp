// Motor: time constant and velocity ripple between command and force.  dF = c (L_tau[L] - L) with L the commanded
// force, or harmonics of the wheel angle.  Never seen in U against F_ref.

#include <cmath>

#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "motor",
    .side = "rig",
    .channel = EffectChannel::rig,
    .summary = "the force follows the command late; the sensor is innocent",
    .equation = "F = L + c (L_tau[L] - L)",
    .source = "Lebosse et al. 2011, fig. 5: final force reached in 70 ms",
    .look_alikes = {"backlash", "lag"},
    .separates = "a step command: F_ref against the wheel angle stays a single curve",
    .needs = {"command"},
    .forms = {{.name = "one_pole",
               .shape = {{"tau_s", "s", 1e-3, 10.0, 0.05, "time constant"}},
               .strength = {{"c", "1", -2.0, 2.0, 0.0, "share of the command behind the pole"}},
               .sign = StrengthSign::positive,
               .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{0.3}, {0.8}}; },
               .columns =
                   [](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                     out.setZero();
                     if (r.F_cmd_N.empty() || r.rig_force_N.empty()) return;
                     const auto y = low_pass_channel(r, r.rig_force_N, shape[0], r.rig_force_N[0]);
                     for (std::size_t i = 0; i < r.rows(); ++i)
                       out(static_cast<Eigen::Index>(i), 0) = y[i] - r.rig_force_N[i];
                   }}}}};

}  // namespace
}  // namespace forcegate
