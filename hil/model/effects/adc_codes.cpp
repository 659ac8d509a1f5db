// Converter bit errors: a wrong weight of a high bit makes jumps at 1/2, 1/4, 3/4 of the range; follows U, not F.
//   dU = g sum_b c_b (bit_b(U) - s_b x - mean), x = (U - low) / range
// bits of U over the declared voltage range, or over one that converters usually have. s_b: the straight line through the steps over all
// readings of the campaign. It belongs to the gain: left in, bits in the ratio 8 : 4 : 2 : 1 are U itself, and U explains its own noise.
// An error of several percent moves the reading past the code that made it: then the bits are those of what came in, told from the force.

#include <algorithm>
#include <array>
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
    // a range of twice, four times the size has the same bits, the highest of them never set
    if (low > -0.01 * range && high < range && out.size() < 2 &&
        std::ranges::none_of(out, [&](const auto& taken) { return std::exp2(std::round(std::log2(range / taken[0]))) * taken[0] == range; }))
      out.push_back({range});
  return out;
}

constexpr std::size_t kBits = 4;

// Of the range, 0 to just below 1.
double share(const CampaignInput& c, double U_V, double range_V) {
  return std::isfinite(U_V) ? std::clamp((U_V - lowest_V(c)) / range_V, 0.0, 0.999999) : U_V;
}

std::array<double, kBits> bits(double x) {
  std::array<double, kBits> out{};
  for (double& bit : out) {
    x *= 2.0;
    bit = x >= 1.0 ? 1.0 : 0.0;
    x -= bit;
  }
  return out;
}

// The readings of a record: what the converter gave, or what came in by a straight line in the base force.
class Readings {
 public:
  Readings(const CampaignInput& c, const RecordInput& r, double range_V, bool came_in) : c_(c), r_(r), range_V_(range_V), came_in_(came_in) {
    if (!came_in) return;
    double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    for (std::size_t i = 0; i < r.rows(); ++i) {
      const double F = r.base_force_N(i), U = r.U_V[i];
      if (!r.ok[i] || !std::isfinite(F) || !std::isfinite(U)) continue;
      n += 1.0, x += F, y += U, xx += F * F, xy += F * U;
    }
    const double spread = n * xx - x * x;
    slope_ = spread > 1e-9 * n * xx ? (n * xy - x * y) / spread : 0.0;
    level_ = n > 0.0 ? (y - slope_ * x) / n : 0.0;
  }
  double share(std::size_t row) const {
    return forcegate::share(c_, came_in_ ? level_ + slope_ * r_.base_force_N(row) : r_.U_V[row], range_V_);
  }

 private:
  const CampaignInput& c_;
  const RecordInput& r_;
  double range_V_;
  bool came_in_;
  double slope_ = 0.0, level_ = 0.0;
};

// Straight lines through the steps, least squares over readings of all records.
struct Lines {
  double middle = 0.0;
  std::array<double, kBits> mean{}, slope{};
};

Lines lines_of(const CampaignInput& c, double range_V, bool came_in) {
  constexpr std::size_t kReadings = 500;  // of a record
  Lines out;
  std::array<double, kBits> product{};
  double n = 0.0, square = 0.0;
  for (const RecordInput& r : c.records) {
    const Readings readings(c, r, range_V, came_in);
    for (std::size_t i = 0; i < r.rows(); i += 1 + r.rows() / kReadings) {
      const double x = readings.share(i);
      if (!std::isfinite(x)) continue;
      const auto bit = bits(x);
      n += 1.0;
      out.middle += x;
      square += x * x;
      for (std::size_t b = 0; b < kBits; ++b) {
        out.mean[b] += bit[b];
        product[b] += bit[b] * x;
      }
    }
  }
  if (n < 2.0) return out;
  out.middle /= n;
  const double variance = square / n - out.middle * out.middle;
  for (std::size_t b = 0; b < kBits; ++b) {
    out.mean[b] /= n;
    out.slope[b] = variance > 1e-12 ? (product[b] / n - out.mean[b] * out.middle) / variance : 0.0;
  }
  return out;
}

EffectForm bit_weights(const char* name, bool came_in) {
  return {.name = name,
          .shape = {{"range_V", "V", 1e-3, 1e4, 10.0, "span of the converter from its lowest code to its highest"}},
          .strength = {{"bit1_N", "N", -10.0, 10.0, 0.0, "error of the highest bit"},
                       {"bit2_N", "N", -10.0, 10.0, 0.0, "second bit"},
                       {"bit3_N", "N", -10.0, 10.0, 0.0, "third bit"},
                       {"bit4_N", "N", -10.0, 10.0, 0.0, "fourth bit"}},
          .sign = StrengthSign::either,
          .grid = ranges_V,
          .columns =
              [came_in](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                const Lines lines = lines_of(c, shape[0], came_in);
                const Readings readings(c, r, shape[0], came_in);
                for (std::size_t i = 0; i < r.rows(); ++i) {
                  const double x = readings.share(i);
                  const auto bit = bits(x);
                  for (std::size_t b = 0; b < kBits; ++b)
                    out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(b)) =
                        std::isfinite(x) ? bit[b] - lines.mean[b] - lines.slope[b] * (x - lines.middle) : 0.0;
                }
              },
          .refine = false,
          .singles = true};
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "adc_codes",
    .side = "instrument",
    .summary = "the output jumps at fixed codes of the converter",
    .equation = "dU = g sum_b c_b (bit_b(U) less its straight line in U)",
    .source = "bit weight error of successive approximation converters",
    .look_alikes = {"static_nonlinearity"},
    .separates = "a slow ramp: histogram of codes has gaps or piles at binary fractions",
    .needs = {},
    .forms = {bit_weights("bit_weights", false), bit_weights("bit_weights_of_input", true)}}};

}  // namespace
}  // namespace forcegate
