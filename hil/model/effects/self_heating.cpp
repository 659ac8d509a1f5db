// Self-heating: the power that the sensor itself turns into heat, ~ W at constant drive, changes its gain behind a
// thermal lag.  dU = g c W L[P]/R,  tau L' + L = P,  P = W (V/5 V)^2 with the drive V where it is known, else P = W.

#include <cmath>

#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

constexpr double kDrive_V = 5.0;  // the strength is told for it

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "self_heating",
    .side = "sensor",
    .summary = "the gain follows the sensor's own dissipation with a thermal lag",
    .equation = "dU = g c W L[P]/R, tau L' + L = P, P = W (V/5 V)^2",
    .source = "thermal balance of a film sensor; Proceedings 1 (2017) 813",
    .look_alikes = {"creep", "thermal"},
    .separates =
        "holds at two loads, each at two drive voltages: the effect grows with the square of the drive",
    .needs = {},
    .forms = {
        {.name = "one_pole",
         .shape = {{"tau_s", "s", 1.0, 1e4, 100.0, "thermal time constant"}},
         .strength = {{"c", "1", -2.0, 2.0, 0.0, "relative change of gain at full load, driven by 5 V"}},
         .sign = StrengthSign::either,
         .grid =
             [](const CampaignInput&) {
               return std::vector<std::vector<double>>{{20.0}, {80.0}, {300.0}};
             },
         .columns =
             [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
               std::vector<double> P(r.rows());
               for (std::size_t i = 0; i < r.rows(); ++i) {
                 const double V = r.drive_V.empty() ? r.drive_mean_V : r.drive_V[i];
                 const double v = std::isnan(V) ? 1.0 : V / kDrive_V;
                 P[i] = v * v * r.base_force_N(i) / c.range_N;
               }
               const auto heat = low_pass_channel(r, P, shape[0], 0.0);
               r.for_each_wanted([&](std::size_t i) { out(static_cast<Eigen::Index>(i), 0) = heat[i] * r.base_force_N(i); });
             }}}}};

}  // namespace
}  // namespace forcegate
