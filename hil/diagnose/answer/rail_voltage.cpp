#include "hil/diagnose/answer/rail_voltage.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "hil/base/quantile.h"

namespace forcegate::diagnose {

namespace {

struct Beyond {
  double by_N, U;
};

std::vector<double> outputs(std::span<const Beyond> rows) {
  std::vector<double> out;
  for (const Beyond& b : rows) out.push_back(b.U);
  return out;
}

}  // namespace

std::optional<FoundParameter> rail_voltage(const CampaignInput& campaign, const ResidualChannel& channel, const ChosenEffect& chosen) {
  constexpr double kBeyond = 0.03, kStillRises = 0.1;  // of the force range, of the span
  constexpr std::size_t kFewestRows = 10, kFewestRecords = 2;
  const Eigen::Index column = channel.problem.nz + columns_of(channel, chosen.variant).front();
  std::vector<Beyond> all;
  std::vector<double> medians;
  for (std::size_t k = 0; k < channel.rows.size(); ++k) {
    const RecordInput& r = campaign.records[channel.record_of[k]];
    const RecordRows& rows = channel.rows[k];
    std::vector<Beyond> own;
    for (std::size_t i = 0; i < rows.row.size(); ++i)
      if (const double by_N = -rows.matrix(static_cast<Eigen::Index>(i), column) / channel.column_factor; by_N > kBeyond * campaign.range_N)
        own.push_back({by_N, r.U_V[rows.row[i]]});
    if (own.size() < kFewestRows) continue;
    medians.push_back(median(outputs(own)));
    all.insert(all.end(), own.begin(), own.end());
  }
  if (medians.size() < kFewestRecords) return std::nullopt;
  std::ranges::sort(all, {}, &Beyond::by_N);
  const std::span<const Beyond> rows(all);
  const double rise = median(outputs(rows.subspan(rows.size() / 2))) - median(outputs(rows.first(rows.size() / 2)));
  if (std::abs(rise) > kStillRises * campaign.U_range_V) return std::nullopt;
  double mean = 0.0, square = 0.0;
  const double n = static_cast<double>(medians.size());
  for (const double m : medians) mean += m / n;
  for (const double m : medians) square += (m - mean) * (m - mean);
  return FoundParameter{"rail_" + channel.unit, median(outputs(all)), std::sqrt(square / (n * (n - 1.0)) + 0.25 * rise * rise), channel.unit};
}

std::optional<double> rise_beyond_rail(const Workspace& w, double corner_N) {
  constexpr double kBeyond = 0.03, kOfNoise = 10.0;  // of the force range
  constexpr std::size_t kFewestRows = 5;
  double rise = 0.0, without = 0.0;
  for (std::size_t k = 0; k < w.input.records.size(); ++k) {
    const RecordInput& r = w.input.records[k];
    const double least_N = corner_N + kBeyond * w.input.range_N;
    double most_N = least_N;
    for (std::size_t i = 0; i < r.rows(); ++i)
      if (r.ok[i] != 0) most_N = std::max(most_N, r.base_force_N(i));
    struct Half {
      std::vector<double> W, U;
    } lower, upper;
    for (std::size_t i = 0; i < r.rows(); ++i) {
      const double W = r.base_force_N(i);
      if (r.ok[i] == 0 || !(W > least_N)) continue;
      Half& half = W < 0.5 * (least_N + most_N) ? lower : upper;
      half.W.push_back(W);
      half.U.push_back(r.U_V[i]);
    }
    if (lower.W.size() < kFewestRows || upper.W.size() < kFewestRows) continue;
    const double straight_V = w.gain_V_per_N * (median(upper.W) - median(lower.W));
    if (std::abs(straight_V) < kOfNoise * w.noise_V[k]) continue;
    rise += std::copysign(1.0, straight_V) * (median(upper.U) - median(lower.U));
    without += std::abs(straight_V);
  }
  return without > 0.0 ? std::optional(rise / without) : std::nullopt;
}

}  // namespace forcegate::diagnose
