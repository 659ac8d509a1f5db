// Converter bit errors: a wrong weight of a high bit makes jumps at 1/2, 1/4, 3/4 of the range; follows U, not F.
//   dU = g sum_k c_k (bit_k(U) - 2 bit_k+1(U) - s_k x - mean), x = (U' - low) / range
// bits of U over the declared voltage range, or over one that converters usually have, that the steps of the readings tell, or that counts fill; U' by a straight line in the force; s_k the straight
// line through the steps over all readings of the campaign. What all bits together have too much is another gain, and bits in the ratio
// 8 : 4 : 2 : 1 would be U itself, which explains its own noise: neither is told.
// An error of a percent moves the reading past the code that made it: then the bits are those of what came in, told from the force by the
// straight line through the readings of each record; or, where errors of several percent bend that line too, by one that is found together
// with the jumps.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "hil/model/came_in.h"
#include "hil/model/effect.h"

namespace forcegate {
namespace {

constexpr double kUsualRanges_V[] = {1.0, 1.024, 1.25, 2.0, 2.048, 2.5, 3.0, 3.3, 4.096, 5.0, 10.0, 20.0};

double lowest_V(const CampaignInput& c) { return lowest_code_V(c.bench); }

struct Readings {
  double low_V = 0.0, high_V = 0.0;
};

Readings readings_of(const CampaignInput& c) {
  Readings out;
  for (const RecordInput& r : c.records)
    for (const double U : r.U_V) {
      out.low_V = std::min(out.low_V, U);
      out.high_V = std::max(out.high_V, U);
    }
  return out;
}

// Readings that lie on steps come from a converter, whoever wrote the file: a power of two of its steps is the next range above all of them.
std::vector<std::vector<double>> range_of_steps(double step_V, double high_V) {
  constexpr double kFewest = 6.0, kMost = 18.0, kAlike = 0.01;  // bits, finer steps are those of the text; of a range
  const double bits = std::ceil(std::log2(high_V / step_V));
  if (!(step_V > 0.0) || !(bits >= kFewest && bits <= kMost)) return {};
  const double range_V = step_V * std::exp2(bits);
  for (const double usual_V : kUsualRanges_V)
    if (const double ratio = usual_V / range_V, octave = std::round(std::log2(ratio)); std::abs(ratio / std::exp2(octave) - 1.0) < kAlike)
      return {{usual_V / std::exp2(octave)}};
  return {{range_V}};
}

// Counts are whole steps: the codes below the next power of two hold the same bits as any more of them.
std::vector<std::vector<double>> range_of_counts(const Readings& read) {
  constexpr double kFewest = 6.0, kMost = 32.0, kBelowZero = 0.01;  // bits; of the range
  const double bits = std::floor(std::log2(std::max(1.0, read.high_V))) + 1.0, range = std::exp2(bits);
  if (bits < kFewest || bits > kMost || read.low_V < -kBelowZero * range) return {};
  return {{range}};
}

// Declared, or the two usual ones that come next above all readings.
std::vector<std::vector<double>> ranges_V(const CampaignInput& c) {
  if (std::isfinite(c.bench.voltage_max_V)) return {{c.bench.voltage_max_V - lowest_V(c)}};
  const Readings read = readings_of(c);
  if (c.in_counts && !c.generic) return range_of_counts(read);
  const auto [low, high] = read;
  if (c.generic) return low < 0.0 ? std::vector<std::vector<double>>{} : range_of_steps(c.U_step_V, high);
  std::vector<std::vector<double>> out;
  for (const double range : kUsualRanges_V)
    // a range of twice, four times the size has the same bits, the highest of them never set
    if (low > -0.01 * range && high < range && out.size() < 2 &&
        std::ranges::none_of(out, [&](const auto& taken) {
          return std::exp2(std::round(std::log2(range / taken[0]))) * taken[0] == range;
        }))
      out.push_back({range});
  return out;
}

// Of the range, 0 to just below 1.
double share(const CampaignInput& c, double U_V, double range_V) {
  return std::isfinite(U_V) ? std::clamp((U_V - lowest_V(c)) / range_V, 0.0, 0.999999) : U_V;
}

// Which share of the range a row of a record is.
using Share = std::function<double(std::size_t row)>;
using ShareOf = Share (*)(const CampaignInput&, const RecordInput&, std::span<const double> shape);

Share share_read(const CampaignInput& c, const RecordInput& r, std::span<const double> shape) {
  return [&c, &r, range_V = shape[0]](std::size_t row) { return share(c, r.U_V[row], range_V); };
}

// By the straight line through the record's own readings.
Share share_by_own_line(const CampaignInput& c, const RecordInput& r, std::span<const double> shape) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    const double F = r.base_force_N(i), U = r.U_V[i];
    if (!r.ok[i] || !std::isfinite(F) || !std::isfinite(U)) continue;
    n += 1.0, x += F, y += U, xx += F * F, xy += F * U;
  }
  const double spread = n * xx - x * x, slope = spread > 1e-9 * n * xx ? (n * xy - x * y) / spread : 0.0,
               level = n > 0.0 ? (y - slope * x) / n : 0.0;
  return [&c, &r, slope, level, range_V = shape[0]](std::size_t row) {
    return share(c, level + slope * r.base_force_N(row), range_V);
  };
}

Share share_that_came_in(const CampaignInput& c, const RecordInput& r, std::span<const double> shape) {
  return [&c, &r, range_V = shape[0], slope = shape[1], level = shape[2]](std::size_t row) {
    return share(c, level + slope * r.base_force_N(row), range_V);
  };
}

std::vector<std::vector<double>> lines_that_came_in(const CampaignInput& c) {
  std::vector<std::vector<double>> out = ranges_V(c);
  for (std::vector<double>& shape : out) {
    const CameInLine line = find_came_in(c, lowest_V(c), shape[0]);
    shape.insert(shape.end(), {line.slope_V_per_N, line.level_V});
  }
  return out;
}

// Whose bits, and over what their straight lines are drawn. Over the reading itself its own noise would come in: a few levels of a staircase
// leave bits free that add up to it.
struct Source {
  ShareOf code, line;
};

// Steps of the upper bits, each less twice the next: bits in the ratio 8 : 4 : 2 : 1 are the reading itself, rounded.
constexpr std::size_t kSteps = kUpperBits - 1;

std::array<double, kSteps> steps(double share) {
  const auto bit = upper_bits(share);
  std::array<double, kSteps> out{};
  for (std::size_t k = 0; k < kSteps; ++k) out[k] = bit[k] - 2.0 * bit[k + 1];
  return out;
}

// Straight lines through the steps, least squares over readings of all records.
struct Lines {
  double middle = 0.0;
  std::array<double, kSteps> mean{}, slope{};
};

Lines lines_of(const CampaignInput& c, std::span<const double> shape, const Source& source) {
  constexpr std::size_t kReadings = 500;  // of a record
  Lines out;
  std::array<double, kSteps> product{};
  double n = 0.0, square = 0.0;
  for (const RecordInput& r : c.records) {
    const Share code = source.code(c, r, shape), line = source.line(c, r, shape);
    for (std::size_t i = 0; i < r.rows(); i += 1 + r.rows() / kReadings) {
      const double x = line(i), read = code(i);
      if (!std::isfinite(x + read)) continue;
      const auto step = steps(read);
      n += 1.0;
      out.middle += x;
      square += x * x;
      for (std::size_t k = 0; k < kSteps; ++k) {
        out.mean[k] += step[k];
        product[k] += step[k] * x;
      }
    }
  }
  if (n < 2.0) return out;
  out.middle /= n;
  const double variance = square / n - out.middle * out.middle;
  for (std::size_t k = 0; k < kSteps; ++k) {
    out.mean[k] /= n;
    out.slope[k] = variance > 1e-12 ? (product[k] / n - out.mean[k] * out.middle) / variance : 0.0;
  }
  return out;
}

EffectForm bit_weights(const char* name, const Source& source) {
  return {.name = name,
          .shape = {{"range_V", "V", 1e-3, 1e10, 10.0, "span of the converter from its lowest code to its highest"}},
          .strength = {{"bit1_N", "N", -10.0, 10.0, 0.0, "error of the highest bit, less twice that of the next"},
                       {"bit2_N", "N", -10.0, 10.0, 0.0, "second bit"},
                       {"bit3_N", "N", -10.0, 10.0, 0.0, "third bit"}},
          .sign = StrengthSign::either,
          .grid = ranges_V,
          .columns =
              [source](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                const Lines lines = lines_of(c, shape, source);
                const Share code = source.code(c, r, shape), line = source.line(c, r, shape);
                r.for_each_wanted([&](std::size_t i) {
                  const double x = line(i), read = code(i);
                  const auto step = steps(read);
                  for (std::size_t k = 0; k < kSteps; ++k)
                    out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
                        std::isfinite(x + read) ? step[k] - lines.mean[k] - lines.slope[k] * (x - lines.middle) : 0.0;
                });
              },
          .refine = false,
          .singles = true};
}

EffectForm large_bit_weights() {
  EffectForm out = bit_weights("large_bit_weights", {share_that_came_in, share_that_came_in});
  out.shape.push_back(
      {"slope_V_per_N", "V/N", -1e10, 1e10, 1.0, "of what came in, per newton of the base force"});
  out.shape.push_back({"level_V", "V", -1e10, 1e10, 0.0, "of what came in at no force"});
  out.grid = lines_that_came_in;
  return out;
}

const Registration<EffectKind> kRegistered{
    EffectKind{.name = "adc_codes",
               .side = "instrument",
               .summary = "the output jumps at fixed codes of the converter",
               .equation = "dU = g sum_k c_k (bit_k(U) - 2 bit_k+1(U), less its straight line in U)",
               .source = "bit weight error of successive approximation converters",
               .look_alikes = {"static_nonlinearity"},
               .separates = "a slow ramp: histogram of codes has gaps or piles at binary fractions",
               .needs = {},
               .traits = {.at_voltages = true, .in_samples = true},
               .forms = {bit_weights("bit_weights", {share_read, share_by_own_line}),
                         bit_weights("bit_weights_of_input", {share_by_own_line, share_by_own_line}),
                         large_bit_weights()}}};

}  // namespace
}  // namespace forcegate
