#include "hil/model/row_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include <Eigen/Cholesky>

#include "hil/base/evenly_chosen.h"
#include "hil/trace/row_length.h"

namespace forcegate {

namespace {

constexpr std::size_t kFewestToTell = 3;  // samples of a row: of two nothing hangs together

// Share of the variance that lies within rows of so many samples, as far as a sample tells of the next: what noise adds does not.
double share_within_rows(std::span<const double> x, std::size_t samples) {
  double sum = 0.0, square = 0.0, n = 0.0, within = 0.0;
  for (std::size_t from = 0; from + samples <= x.size(); from += samples) {
    const std::span<const double> row = x.subspan(from, samples);
    const double of_row = std::accumulate(row.begin(), row.end(), 0.0), middle = of_row / static_cast<double>(samples);
    if (!std::isfinite(middle)) continue;
    double along = 0.0;
    for (std::size_t i = 0; i + 1 < samples; ++i) along += (row[i] - middle) * (row[i + 1] - middle);
    within += along * static_cast<double>(samples) / static_cast<double>(samples - 1);
    sum += of_row;
    square += std::inner_product(row.begin(), row.end(), row.begin(), 0.0);
    n += static_cast<double>(samples);
  }
  const double all = n > 0.0 ? square - sum * sum / n : 0.0;
  return all > 0.0 ? within / all : 0.0;
}

// Less the mean of the row about it; NaN beside a missing sample.
std::vector<double> within_rows(std::span<const double> x, std::size_t samples) {
  std::vector<double> sum(x.size() + 1, 0.0);
  std::vector<std::size_t> there(x.size() + 1, 0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool is = std::isfinite(x[i]);
    sum[i + 1] = sum[i] + (is ? x[i] : 0.0);
    there[i + 1] = there[i] + (is ? 1 : 0);
  }
  const std::size_t before = samples / 2, after = samples - before;
  std::vector<double> out(x.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = before; i + after <= x.size(); ++i)
    if (there[i + after] - there[i - before] == samples) out[i] = x[i] - (sum[i + after] - sum[i - before]) / static_cast<double>(samples);
  return out;
}

// Share of the variance that lies within rows of so many samples and that the output follows, by a filter of some samples. Noise of the reference
// it does not follow, however its samples hang together; a wide band hangs together hardly more than noise.
double share_that_output_follows(std::span<const double> force, std::span<const double> output, std::size_t samples) {
  constexpr std::size_t kEarlier = 2, kTaps = 9, kMost = 50000;
  const std::size_t n = std::min(force.size(), output.size());
  const std::vector<double> F = within_rows(force.first(n), samples), U = within_rows(output.first(n), samples);
  using Taps = Eigen::Matrix<double, kTaps, 1>;
  Eigen::Matrix<double, kTaps, kTaps> FF = Eigen::Matrix<double, kTaps, kTaps>::Zero();
  Taps FU = Taps::Zero();
  double UU = 0.0, within = 0.0, sum = 0.0, square = 0.0, rows = 0.0;
  EvenlyChosen choice(n, kMost);
  for (std::size_t i = kTaps; i + kEarlier < n; ++i) {
    if (!choice.next()) continue;
    Taps taps;
    for (std::size_t k = 0; k < kTaps; ++k) taps(static_cast<Eigen::Index>(k)) = F[i + kEarlier - k];
    if (!std::isfinite(taps.sum() + U[i])) continue;
    FF.noalias() += taps * taps.transpose();
    FU.noalias() += taps * U[i];
    UU += U[i] * U[i], within += F[i] * F[i], sum += force[i], square += force[i] * force[i], rows += 1.0;
  }
  const double all = rows > 0.0 ? square - sum * sum / rows : 0.0;
  if (!(all > 0.0) || !(UU > 0.0)) return 0.0;
  FF.diagonal().array() += 1e-9 * FF.trace();
  return within / all * FU.dot(FF.ldlt().solve(FU)) / UU;
}

}  // namespace

double row_step_of(const Record& record, std::size_t records) {
  constexpr double kRows = 5000.0, kMostRows = 40000.0, kFast = 0.1;
  const Channel *force = record.trace.find("F_ref"), *output = record.trace.find("U");
  if (force == nullptr) return kRowStep_s;
  const std::vector<double>& t_s = record.trace.time_bases[force->time_base].t_s;
  if (t_s.size() < 2) return kRowStep_s;
  const double whole_s = t_s.back() - t_s.front(), sample_s = whole_s / static_cast<double>(t_s.size() - 1);
  const double most_rows = kMostRows / static_cast<double>(std::max<std::size_t>(1, records));
  const bool alone = records == 1, is_short = whole_s < kFewestRows * kRowStep_s;  // for rows of 0.02 s: refused as such
  double out = alone && !is_short ? std::min(kRowStep_s, whole_s / kRows) : kRowStep_s;
  for (bool fast = false; out > sample_s;) {
    const auto samples = static_cast<std::size_t>(samples_of_row(sample_s, out));
    const double shorter = samples >= kFewestToTell ? std::max(0.5 * out, sample_s) : sample_s;
    if (whole_s / shorter > most_rows) break;
    if (samples >= kFewestToTell)
      fast = share_within_rows(force->value, samples) > kFast || (output != nullptr && share_that_output_follows(force->value, output->value, samples) > kFast);
    if (!fast) break;
    out = shorter;
  }
  return out;
}

}  // namespace forcegate
