// Pure delay between the reference's clock and the sensor's: dU = g D c (F(t - d) - F(t)), c = 1 for a whole delay.

#include "hil/model/effect.h"
#include "hil/model/shift_of_start.h"
#include "hil/model/states.h"
#include "hil/model/time_scale.h"

namespace forcegate {
namespace {

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "delay",
    .side = "instrument",
    .summary = "the output is the right curve shifted in time, the same at every load and every edge",
    .equation = "dU = g D c (F(t - d) - F(t))",
    .source = "data acquisition: two devices, one start",
    .look_alikes = {"lag", "clock_skew", "rc", "piezocapacitance"},
    .separates =
        "fast edges sampled at 1 kHz: onset time against slope; phase linear in frequency, no attenuation",
    .needs = {},
    .traits = {.timing = true, .shift = TimeShift::first_shape, .late = true, .known_form = true},
    .forms = {
        {.name = "shift",
         .shape = {{"delay_s", "s", -100.0, 100.0, 0.01, "positive: the sensor's channel is late"}},
         .strength = {{"c", "1", -2.0, 2.0, 0.0, "share of the signal that is delayed"}},
         .sign = StrengthSign::positive,
         .grid =
             [](const CampaignInput& campaign) {
               std::vector<std::vector<double>> out;
               const std::vector<double> scales = time_scales(campaign, 0.02);
               for (const double scale : scales)
                 for (const double delay_s : {0.0004, 0.001, 0.002, 0.004, 0.007, 0.012, 0.02, 0.035, 0.06, 0.1, -0.0004, -0.001, -0.002, -0.004,
                                              -0.008, -0.016, -0.032, -0.064, -0.128})
                   out.push_back({delay_s * scale});
               // two loggers that were started by hand
               for (const double delay_s : {0.14, 0.2, 0.28, 0.4, 0.56, 0.8, -0.25, -0.35, -0.5, -0.7, -1.0})
                 out.push_back({delay_s * scales.back()});
               if (const double shift_s = shift_of_start(campaign); shift_s != 0.0) out.push_back({shift_s});
               return out;
             },
         .columns =
             [](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
               const auto y = delayed_rows(r, shape[0]);
               r.for_each_wanted([&](std::size_t i) { out(static_cast<Eigen::Index>(i), 0) = r.decay[i] * (y[i] - r.F_N[i]); });
             },
         .least = 0.65,
         .most = 1.5}}}};

}  // namespace
}  // namespace forcegate
