#include "hil/model/row_step.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

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

}  // namespace

double row_step_of(const Campaign& campaign) {
  constexpr double kRows = 5000.0, kMostRows = 40000.0, kFast = 0.1;
  const Channel* force = campaign.records.empty() ? nullptr : campaign.records.front().trace.find("F_ref");
  if (campaign.records.size() != 1 || force == nullptr) return kRowStep_s;
  const std::vector<double>& t_s = campaign.records.front().trace.time_bases[force->time_base].t_s;
  if (t_s.size() < 2) return kRowStep_s;
  const double whole_s = t_s.back() - t_s.front(), sample_s = whole_s / static_cast<double>(t_s.size() - 1);
  // what is too short for rows of 0.02 s is refused as such
  double out = whole_s < kFewestRows * kRowStep_s ? kRowStep_s : std::min(kRowStep_s, whole_s / kRows);
  for (bool fast = false; out > sample_s;) {
    const auto samples = static_cast<std::size_t>(samples_of_row(sample_s, out));
    if (samples >= kFewestToTell) fast = share_within_rows(force->value, samples) > kFast;
    const double shorter = samples >= kFewestToTell ? std::max(0.5 * out, sample_s) : sample_s;
    if (!fast || whole_s / shorter > kMostRows) break;
    out = shorter;
  }
  return out;
}

}  // namespace forcegate
