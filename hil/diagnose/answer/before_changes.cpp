#include "hil/diagnose/answer/before_changes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <span>

namespace forcegate::diagnose {

namespace {

using Eigen::Index;

constexpr std::size_t kFewest = 100;

// `row`: rows of the record that `e` belongs to.
void take_steady_levels(const RecordInput& record, std::span<const std::size_t> row, std::vector<double>& e) {
  const auto n = static_cast<Index>(e.size());
  const double from_s = record.t_s[row.front()], lasts_s = std::max(1e-9, record.t_s[row.back()] - from_s);
  Eigen::MatrixX4d levels(n, 4);
  for (Index i = 0; i < n; ++i) {
    const std::size_t at = row[static_cast<std::size_t>(i)];
    const double t = (record.t_s[at] - from_s) / lasts_s;
    levels.row(i) << 1.0, t, record.F_N[at], record.F_N[at] * t;
  }
  Eigen::Map<Eigen::VectorXd> left(e.data(), n);
  left -= levels * levels.colPivHouseholderQr().solve(left);
}

}  // namespace

std::vector<std::vector<double>> before_changes_of_frequency(const CampaignInput& input, const ResidualChannel& channel,
                                                             std::vector<std::vector<double>> residual) {
  for (std::size_t k = 0; k < residual.size(); ++k) {
    const RecordInput& record = input.records[channel.record_of[k]];
    if (!record.dynamic || record.frequency_jumps_s.empty()) continue;
    const std::vector<std::size_t>& row = channel.rows[k].row;
    const auto end = std::ranges::find_if(row, [&](std::size_t at) { return record.t_s[at] >= record.frequency_jumps_s.front(); });
    const auto before = static_cast<std::size_t>(end - row.begin());
    residual[k].resize(before < kFewest ? 0 : std::min(before, residual[k].size()));
    if (!residual[k].empty()) take_steady_levels(record, std::span(row).first(residual[k].size()), residual[k]);
  }
  return residual;
}

}  // namespace forcegate::diagnose
