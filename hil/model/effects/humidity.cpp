// Humidity: dU = g (c_gain W + c_offset R)(h_s - h_ref), h_s the measured humidity behind a slow lag.
// Hot and humid +10 % resistance, storage +30 % (Interlink FSR 400 data sheet).

#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

double reference_humidity(const CampaignInput& c) {
  double sum = 0.0, n = 0.0;
  for (const RecordInput& r : c.records)
    for (double T : r.humidity) {
      sum += T;
      n += 1.0;
    }
  return n > 0.0 ? sum / n : 0.0;
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "humidity",
    .side = "sensor",
    .summary = "gain or offset follows the humidity, slowly and across records",
    .equation = "dU = g (c_gain W + c_offset R)(h_s - h_ref), tau h_s' + h_s = h",
    .source = "Interlink FSR 400 data sheet",
    .look_alikes = {"thermal", "creep", "wear", "reference_drift", "self_heating"},
    .separates = "one ramp repeated over hours with the humidity recorded",
    .needs = {"humidity"},
    .forms = {{.name = "lagged",
               .shape = {{"tau_s", "s", 0.0, 1e5, 60.0, "time constant of the sensor behind the hygrometer"}},
               .strength = {{"c_gain_per_pct", "1/%", -0.1, 0.1, 0.0, "relative change of gain"},
                            {"c_offset_per_pct", "1/%", -0.1, 0.1, 0.0, "change of offset, shares of the span"}},
               .sign = StrengthSign::either,
               .grid =
                   [](const CampaignInput&) {
                     return std::vector<std::vector<double>>{{0.0}, {60.0}, {240.0}, {800.0}, {2400.0}};
                   },
               .columns =
                   [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                     out.setZero();
                     if (r.humidity.empty()) return;
                     const double T0 = reference_humidity(c);
                     const auto T = shape[0] > 0.0 ? low_pass_channel(r, r.humidity, shape[0], r.humidity[0]) : r.humidity;
                     for (std::size_t i = 0; i < r.rows(); ++i) {
                       const auto row = static_cast<Eigen::Index>(i);
                       out(row, 0) = (T[i] - T0) * r.base_force_N(i);
                       out(row, 1) = (T[i] - T0) * c.range_N;
                     }
                   },
               .singles = true}}}};

}  // namespace
}  // namespace forcegate
