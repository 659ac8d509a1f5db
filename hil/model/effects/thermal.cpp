// Thermal gain and offset: dU = g (c_gain W + c_offset R) (T_s - T_ref), T_s = the measured temperature behind a lag.
// Up to 0.36 %/C (maker's figure for FlexiForce); resistance -15 % at +85 C, -5 % at -40 C for FSR (Interlink).

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

double reference_temperature(const CampaignInput& c) {
  double sum = 0.0, n = 0.0;
  for (const RecordInput& r : c.records)
    for (double T : r.temp_C) {
      sum += T;
      n += 1.0;
    }
  return n > 0.0 ? sum / n : 0.0;
}

// Nobody wrote the temperature down: the gain moves smoothly over the campaign, whatever is done to the sensor.
EffectForm unrecorded() {
  return {.name = "unrecorded",
          .shape = {},
          .strength = {{"k1", "1", -1.0, 1.0, 0.0, "half wave of the gain over the campaign"},
                       {"k2", "1", -1.0, 1.0, 0.0, "one wave"},
                       {"k3", "1", -1.0, 1.0, 0.0, "one and a half waves"},
                       {"k4", "1", -1.0, 1.0, 0.0, "two waves"}},
          .sign = StrengthSign::either,
          .grid = [](const CampaignInput& c) {
            return c.has_temp || c.single ? std::vector<std::vector<double>>{} : std::vector<std::vector<double>>{{}};
          },
          .columns = [](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
            double T = 1.0;
            for (const RecordInput& other : c.records) T = std::max(T, other.start_s + other.duration_s);
            for (std::size_t i = 0; i < r.rows(); ++i)
              for (int k = 1; k <= 4; ++k)
                out(static_cast<Eigen::Index>(i), k - 1) =
                    r.base_force_N(i) * std::cos(k * std::numbers::pi * (r.start_s + r.t_s[i]) / T);
          }};
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "thermal",
    .side = "sensor",
    .summary = "gain or offset follows the temperature, smoothly and across records",
    .equation = "dU = g (c_gain W + c_offset R)(T_s - T_ref), tau T_s' + T_s = T",
    .source = "Tekscan FlexiForce manual rev. G; Interlink FSR 400 data sheet; Sensors 20 (2020) 6863",
    .look_alikes = {"creep", "wear", "reference_drift", "humidity", "self_heating"},
    .separates = "one ramp repeated over hours with the temperature recorded; heating without loading",
    .needs = {},
    .forms = {unrecorded(), {.name = "lagged",
               .shape = {{"tau_s", "s", 0.0, 1e5, 60.0, "time constant of the sensor behind the thermometer"}},
               .strength = {{"c_gain_per_C", "1/degC", -0.1, 0.1, 0.0, "relative change of gain"},
                            {"c_offset_per_C", "1/degC", -0.1, 0.1, 0.0, "change of offset, shares of the span"}},
               .sign = StrengthSign::either,
               .grid =
                   [](const CampaignInput& c) {
                     return c.has_temp ? std::vector<std::vector<double>>{{0.0}, {60.0}, {240.0}, {800.0}, {2400.0}}
                                       : std::vector<std::vector<double>>{};
                   },
               .columns =
                   [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                     out.setZero();
                     if (r.temp_C.empty()) return;
                     const double T0 = reference_temperature(c);
                     const auto T = shape[0] > 0.0 ? low_pass_channel(r, r.temp_C, shape[0], r.temp_C[0]) : r.temp_C;
                     for (std::size_t i = 0; i < r.rows(); ++i) {
                       const auto row = static_cast<Eigen::Index>(i);
                       out(row, 0) = (T[i] - T0) * r.base_force_N(i);
                       out(row, 1) = (T[i] - T0) * c.range_N;
                     }
                   },
               .singles = true}}}};

}  // namespace
}  // namespace forcegate
