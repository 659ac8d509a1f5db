#include "hil/diagnose/answer/steady_line.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "hil/base/portable_math.h"
#include "hil/base/quantile.h"
#include "hil/diagnose/answer/window_power.h"
#include "hil/diagnose/raw/line_peak.h"
#include "hil/diagnose/raw/record_scales.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kSlowest = 4, kWidth = 2;  // kWidth: bins on either side that belong to a line
using Power = std::array<double, kPowerWindow / 2>;

Power power_of(std::span<const double> x) {
  std::array<double, kPowerWindow> windowed{};
  double mean = 0.0;
  for (const double v : x) mean += v / static_cast<double>(kPowerWindow);
  for (std::size_t i = 0; i < kPowerWindow; ++i)  // Hann
    windowed[i] = (x[i] - mean) * (0.5 - 0.5 * portable::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(kPowerWindow)));
  return window_power(windowed);
}

double around(const Power& p, std::size_t k) {
  double sum = 0.0;
  for (std::size_t j = k - std::min(k, kWidth); j <= std::min(p.size() - 1, k + kWidth); ++j) sum += p[j];
  return sum;
}

struct Peak {
  double bin = 0.0, share = 0.0;  // share of the power of the window
};

// The highest line, where it stands alone: nothing else in the window is a fifth of it, and the load has not a part of it there.
Peak peak_of(const Power& left, const Power& load) {
  constexpr double kAlone = 0.2, kOfLoad = 1.0;
  const std::size_t k = static_cast<std::size_t>(std::max_element(left.begin() + kSlowest, left.end()) - left.begin());
  double total = 0.0, next = 0.0;
  for (std::size_t j = 1; j < left.size(); ++j) {
    total += left[j];
    if (j + kWidth < k || j > k + kWidth) next = std::max(next, left[j]);
  }
  const double own = around(left, k);
  if (!(total > 0.0) || next > kAlone * left[k] || around(load, k) > kOfLoad * own) return {};
  double moment = 0.0, weight = 0.0;
  for (std::size_t j = k - 1; j <= std::min(left.size() - 1, k + 1); ++j) {
    moment += static_cast<double>(j) * left[j];
    weight += left[j];
  }
  return {moment / weight, own / total};
}

// What a window of the output has beside a parabola, the force and its rate: 256 rows that follow each other from `from`.
Eigen::VectorXd left_in_window(const RecordInput& r, std::size_t from) {
  const auto n = static_cast<Eigen::Index>(kPowerWindow);
  Eigen::MatrixXd X(n, 5);
  Eigen::VectorXd y(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t at = from + static_cast<std::size_t>(i);
    const double x = 2.0 * static_cast<double>(i) / static_cast<double>(n - 1) - 1.0;
    X.row(i) << 1.0, x, x * x, r.F_N[at], r.rate_N_per_s[at];
    y[i] = r.U_V[at];
  }
  return y - X * X.colPivHouseholderQr().solve(y);
}

// What the law of the sensor lacks comes again with the load.
bool is_harmonic_of_load(const RecordInput& record, double bin) {
  constexpr double kHighest = 8.5, kSameBin = 1.0;
  const double rate_Hz = 1.0 / record.row_step_s, load = cycles_per_s(record.F_N, rate_Hz) / rate_Hz * static_cast<double>(kPowerWindow);
  return load > 0.0 && bin < kHighest * load && std::abs(bin - load * std::round(bin / load)) < kSameBin;
}

struct Line {
  double frequency_Hz, amplitude_V;
};

// Of one record: nothing where its windows do not agree. `asked`: it has some.
std::optional<Line> line_of(const RecordInput& record, double gain_V_per_N, bool& asked) {
  constexpr std::size_t kFewest = 3, kMostWindows = 40;
  constexpr double kHalf = 0.5, kMost = 0.7, kSameBin = 1.0;
  std::vector<std::size_t> whole;
  for (std::size_t from = 0, i = 0; i < record.rows(); ++i) {
    const bool follows = i == 0 || record.t_s[i] - record.t_s[i - 1] < 1.5 * record.row_step_s;
    if (record.ok[i] == 0 || !std::isfinite(record.U_V[i]) || !follows) from = record.ok[i] == 0 || !std::isfinite(record.U_V[i]) ? i + 1 : i;
    if (i + 1 < from + kPowerWindow) continue;
    whole.push_back(from);
    from = i + 1;
  }
  asked = whole.size() >= kFewest;
  if (!asked) return std::nullopt;
  std::vector<double> bin, share, square, load(kPowerWindow);
  const std::size_t stride = (whole.size() + kMostWindows - 1) / kMostWindows;
  std::size_t windows = 0;
  for (std::size_t w = 0; w < whole.size(); w += stride, ++windows) {
    for (std::size_t i = 0; i < kPowerWindow; ++i) load[i] = gain_V_per_N * record.F_N[whole[w] + i];
    const Eigen::VectorXd left = left_in_window(record, whole[w]);
    const Peak peak = peak_of(power_of({left.data(), kPowerWindow}), power_of(load));
    if (!(peak.share > kHalf)) continue;
    bin.push_back(peak.bin);
    share.push_back(peak.share);
    square.push_back(left.squaredNorm() / static_cast<double>(kPowerWindow));
  }
  const double most = kMost * static_cast<double>(windows);
  if (static_cast<double>(bin.size()) < most) return std::nullopt;
  const double middle = quantile(bin, 0.5);
  if (is_harmonic_of_load(record, middle)) return std::nullopt;
  if (static_cast<double>(std::ranges::count_if(bin, [&](double b) { return std::abs(b - middle) < kSameBin; })) < most) return std::nullopt;
  return Line{middle / (record.row_step_s * static_cast<double>(kPowerWindow)), std::sqrt(2.0 * quantile(share, 0.5) * quantile(square, 0.5))};
}

// Rounding of a steady ramp is a saw-tooth; the amplitude of its line is a step over pi.
double line_of_rounding_V(const Workspace& w, const RecordHealth& h) {
  constexpr double kOfStep = 0.4;
  const double step_V = std::max(h.lsb_U_V, declared_step_V(w.input)), step_N = std::max(h.lsb_F_N, declared_step_N(w.input.bench));
  return kOfStep * std::max(step_V, std::abs(w.scales.gain_V_per_N) * step_N);
}

}  // namespace

std::optional<SteadyLine> steady_line(const Workspace& w) {
  constexpr double kLeast = 0.0015;  // of the span
  std::vector<double> frequency_Hz, amplitude_V;
  std::size_t asked = 0;
  for (std::size_t k = 0; k < w.input.records.size(); ++k) {
    const RecordInput& record = w.input.records[k];
    bool can_tell = false;
    const std::optional<Line> line = line_of(record, w.scales.gain_V_per_N, can_tell);
    asked += can_tell ? 1 : 0;
    if (!line || !(line->amplitude_V > std::max(kLeast * w.output.scale, line_of_rounding_V(w, w.health[k])))) continue;
    frequency_Hz.push_back(line->frequency_Hz);
    amplitude_V.push_back(line->amplitude_V);
  }
  if (frequency_Hz.empty() || 2 * frequency_Hz.size() < asked || frequency_Hz.size() < std::min<std::size_t>(2, asked)) return std::nullopt;
  return SteadyLine{quantile(std::move(frequency_Hz), 0.5), quantile(std::move(amplitude_V), 0.5)};
}

}  // namespace forcegate::diagnose
