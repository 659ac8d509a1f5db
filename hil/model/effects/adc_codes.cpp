// Converter bit errors: a wrong weight of a high bit makes jumps at 1/2, 1/4, 3/4 of the range; follows U, not F.
//   dU = g sum_b c_b (bit_b(U) - 1/2), bits of U over the declared voltage range, or over one that converters usually have.

#include <algorithm>
#include <cmath>

#include "hil/model/effect.h"

namespace forcegate {
namespace {

constexpr double kUsualRanges_V[] = {1.0, 1.024, 1.25, 2.0, 2.048, 2.5, 3.0, 3.3, 4.096, 5.0, 10.0, 20.0};

double lowest_V(const CampaignInput& c) {
  return std::isfinite(c.bench.voltage_min_V) ? c.bench.voltage_min_V : 0.0;
}

// Declared, or the two usual ones that come next above all readings.
std::vector<std::vector<double>> ranges_V(const CampaignInput& c) {
  if (std::isfinite(c.bench.voltage_max_V)) return {{c.bench.voltage_max_V - lowest_V(c)}};
  if (c.generic) return {};  // nothing says that there is a converter at all
  double low = 0.0, high = 0.0;
  for (const RecordInput& r : c.records)
    for (const double U : r.U_V) {
      low = std::min(low, U);
      high = std::max(high, U);
    }
  std::vector<std::vector<double>> out;
  for (const double range : kUsualRanges_V)
    if (low > -0.01 * range && high < range && out.size() < 2) out.push_back({range});
  return out;
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "adc_codes",
    .side = "instrument",
    .summary = "the output jumps at fixed codes of the converter",
    .equation = "dU = g sum_b c_b (bit_b(U) - 1/2)",
    .source = "bit weight error of successive approximation converters",
    .look_alikes = {"static_nonlinearity"},
    .separates = "a slow ramp: histogram of codes has gaps or piles at binary fractions",
    .needs = {},
    .forms = {
        {.name = "bit_weights",
         .shape = {{"range_V", "V", 1e-3, 1e4, 10.0,
                    "span of the converter from its lowest code to its highest"}},
         .strength = {{"bit1_N", "N", -10.0, 10.0, 0.0, "error of the highest bit"},
                      {"bit2_N", "N", -10.0, 10.0, 0.0, "second bit"},
                      {"bit3_N", "N", -10.0, 10.0, 0.0, "third bit"},
                      {"bit4_N", "N", -10.0, 10.0, 0.0, "fourth bit"}},
         .sign = StrengthSign::either,
         .grid = ranges_V,
         .columns =
             [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
               const double low = lowest_V(c);
               for (std::size_t i = 0; i < r.rows(); ++i) {
                 double rest = std::clamp((r.U_V[i] - low) / shape[0], 0.0, 0.999999);
                 for (int b = 0; b < 4; ++b) {
                   rest *= 2.0;
                   const double bit = rest >= 1.0 ? 1.0 : 0.0;
                   rest -= bit;
                   out(static_cast<Eigen::Index>(i), b) = std::isfinite(rest) ? bit - 0.5 : 0.0;
                 }
               }
             },
         .refine = false,
         .singles = true}}}};

}  // namespace
}  // namespace forcegate
