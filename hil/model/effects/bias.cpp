// Drive-voltage dependence: tunnelling conduction is voltage dependent, the decay vanishes below 1.5 V.
//   dU = g (c_gain W + c_decay (1 - D)(F - Fmin)) (V - Vref)/Vref,  V the drive of the record;
//   the same with tanh(V/V0)/tanh(Vref/V0) - 1 for (V - Vref)/Vref;
//   dU = g c_gain W (1 - Vref/V) for a gain that levels off at high drive.
// Sensors (2017) static loading; tanh law below 1 V: Sensors 11 (2011) 8836; Proceedings 1 (2017) 813.

#include <cmath>

#include "hil/model/effect.h"
#include "hil/model/model_frame.h"

namespace forcegate {
namespace {

RecordedCause drive() {
  return {"drive", "V", [](const RecordInput& r) { return r.drive_mean_V; }, 0.5};
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "bias",
    .side = "sensor",
    .summary = "gain or decay differs from record to record with the drive voltage",
    .equation = "dU = g (c_gain W + c_decay (1 - D)(F - Fmin)) (V - Vref)/Vref",
    .source = "Sensors 11 (2011) 8836; Proceedings 1 (2017) 813",
    .look_alikes = {"wear", "thermal", "mounting"},
    .separates = "one ramp at several drive voltages in random order",
    .needs = {Need::drive},
    .traits = {.between_records = true, .needs_records = true},
    .forms = {
        {.name = "relative",
         .shape = {},
         .strength = {{"c_gain", "1", -3.0, 3.0, 0.0, "relative gain per relative drive"},
                      {"c_decay", "1", -3.0, 3.0, 0.0, "relative decay per relative drive"}},
         .sign = StrengthSign::either,
         .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; },
         .columns =
             [](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
               out.setZero();
               if (!(r.drive_mean_V == r.drive_mean_V)) return;
               const double mean = reference_drive_V(c);
               r.for_each_wanted([&](std::size_t i) {
                 const double V = r.drive_V.empty() ? r.drive_mean_V : r.drive_V[i];
                 const double v = (V - mean) / mean;
                 const auto row = static_cast<Eigen::Index>(i);
                 out(row, 0) = v * r.base_force_N(i);
                 out(row, 1) = -v * (1.0 - r.decay[i]) * (r.F_N[i] - r.F_min_N);
               });
             },
         .singles = true,
         .cause = drive()},
        {.name = "saturating",
         .shape = {{"V0_V", "V", 0.05, 100.0, 1.5, "drive at which the output levels off"}},
         .strength = {{"c_gain", "1", -3.0, 3.0, 0.0, "share of the output that follows tanh(V/V0)"},
                      {"c_decay", "1", -3.0, 3.0, 0.0, "share of the loss of the swing that follows it"}},
         .sign = StrengthSign::either,
         .grid =
             [](const CampaignInput&) {
               return std::vector<std::vector<double>>{{0.7}, {1.4}, {2.8}, {5.6}};
             },
         .columns =
             [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
               out.setZero();
               if (!(r.drive_mean_V == r.drive_mean_V)) return;
               const double reference = std::tanh(reference_drive_V(c) / shape[0]);
               r.for_each_wanted([&](std::size_t i) {
                 const double V = r.drive_V.empty() ? r.drive_mean_V : r.drive_V[i];
                 const double v = std::tanh(V / shape[0]) / reference - 1.0;
                 const auto row = static_cast<Eigen::Index>(i);
                 out(row, 0) = v * r.base_force_N(i);
                 out(row, 1) = -v * (1.0 - r.decay[i]) * (r.F_N[i] - r.F_min_N);
               });
             },
         .singles = true,
         .cause = drive()},
        {.name = "inverse",
         .shape = {},
         .strength = {{"c_gain", "1", -3.0, 3.0, 0.0, "relative gain lost per Vref/V"}},
         .sign = StrengthSign::either,
         .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; },
         .columns =
             [](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
               out.setZero();
               if (!(r.drive_mean_V > 0.0)) return;
               const double v = 1.0 - reference_drive_V(c) / r.drive_mean_V;
               r.for_each_wanted([&](std::size_t i) { out(static_cast<Eigen::Index>(i), 0) = v * r.base_force_N(i); });
             },
         .cause = drive()}}}};

}  // namespace
}  // namespace forcegate
