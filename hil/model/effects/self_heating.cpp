// Self-heating: the power that the sensor itself turns into heat, ~ W at constant drive, changes its gain behind a
// thermal lag.  dU = g c W L[W]/R,  tau L' + L = W.

#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "self_heating",
    .side = "sensor",
    .summary = "the gain follows the sensor's own dissipation with a thermal lag",
    .equation = "dU = g c W L[W]/R, tau L' + L = W",
    .source = "thermal balance of a film sensor; Proceedings 1 (2017) 813",
    .look_alikes = {"creep", "thermal"},
    .separates =
        "holds at two loads, each at two drive voltages: the effect grows with the square of the drive",
    .needs = {},
    .forms = {
        {.name = "one_pole",
         .shape = {{"tau_s", "s", 1.0, 1e4, 100.0, "thermal time constant"}},
         .strength = {{"c", "1", -2.0, 2.0, 0.0, "relative change of gain at full load"}},
         .sign = StrengthSign::either,
         .grid =
             [](const CampaignInput&) {
               return std::vector<std::vector<double>>{{20.0}, {80.0}, {300.0}};
             },
         .columns =
             [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
               std::vector<double> P(r.rows());
               for (std::size_t i = 0; i < r.rows(); ++i) {
                 const double v = r.drive_mean_V == r.drive_mean_V ? r.drive_mean_V / 5.0 : 1.0;
                 P[i] = v * v * r.base_force_N(i) / c.range_N;
               }
               const auto heat = low_pass_channel(r, P, shape[0], 0.0);
               r.for_each_wanted([&](std::size_t i) { out(static_cast<Eigen::Index>(i), 0) = heat[i] * r.base_force_N(i); });
             }}}}};

}  // namespace
}  // namespace forcegate
