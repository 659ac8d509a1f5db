// Converter bit errors: a wrong weight of a high bit makes jumps at 1/2, 1/4, 3/4 of the range; follows U, not F.
//   dU = g sum_b c_b (bit_b(U) - 1/2), bits of U over the declared voltage range.

#include <cmath>

#include "hil/model/effect.h"

namespace forcegate {
namespace {

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "adc_codes",
    .side = "instrument",
    .summary = "the output jumps at fixed codes of the converter",
    .equation = "dU = g sum_b c_b (bit_b(U) - 1/2)",
    .source = "bit weight error of successive approximation converters",
    .look_alikes = {"static_nonlinearity"},
    .separates = "a slow ramp: histogram of codes has gaps or piles at binary fractions",
    .needs = {"range"},
    .forms = {{.name = "bit_weights",
               .shape = {},
               .strength = {{"bit1_N", "N", -10.0, 10.0, 0.0, "error of the highest bit"},
                            {"bit2_N", "N", -10.0, 10.0, 0.0, "second bit"},
                            {"bit3_N", "N", -10.0, 10.0, 0.0, "third bit"},
                            {"bit4_N", "N", -10.0, 10.0, 0.0, "fourth bit"}},
               .sign = StrengthSign::either,
               .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; },
               .columns =
                   [](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
                     const double low = std::isfinite(c.bench.voltage_min_V) ? c.bench.voltage_min_V : 0.0;
                     const double high = std::isfinite(c.bench.voltage_max_V) ? c.bench.voltage_max_V : 10.0;
                     for (std::size_t i = 0; i < r.rows(); ++i) {
                       double rest = std::clamp((r.U_V[i] - low) / (high - low), 0.0, 0.999999);
                       for (int b = 0; b < 4; ++b) {
                         rest *= 2.0;
                         const double bit = rest >= 1.0 ? 1.0 : 0.0;
                         rest -= bit;
                         out(static_cast<Eigen::Index>(i), b) = std::isfinite(rest) ? bit - 0.5 : 0.0;
                       }
                     }
                   },
               .singles = true}}}};

}  // namespace
}  // namespace forcegate
