#include "hil/diagnose/answer/unresolved_edges.h"

#include <algorithm>
#include <cmath>

namespace forcegate::diagnose {

namespace {

constexpr double kFast = 0.05;          // of the force range, from the row before to the row behind
constexpr double kMost = 0.4;           // of the rows: more of them are no edges
constexpr double kSamplesOfARow = 1.5;  // below it a row is one sample
constexpr std::ptrdiff_t kAround = 2;   // rows beside an edge

std::vector<char> edges_of(const RecordInput& record, std::size_t samples, double range_N) {
  const auto n = static_cast<std::ptrdiff_t>(record.rows());
  std::vector<char> out(record.rows(), 0);
  if (static_cast<double>(samples) > kSamplesOfARow * static_cast<double>(n)) return out;
  for (std::ptrdiff_t i = 1; i + 1 < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (std::abs(record.F_N[at + 1] - record.F_N[at - 1]) > kFast * range_N)
      std::fill(out.begin() + std::max<std::ptrdiff_t>(0, i - kAround), out.begin() + std::min(n, i + kAround + 1), char{1});
  }
  if (static_cast<double>(std::count(out.begin(), out.end(), char{1})) > kMost * static_cast<double>(n)) std::fill(out.begin(), out.end(), char{0});
  return out;
}

}  // namespace

std::vector<std::vector<double>> without_unresolved_edges(const CampaignInput& input, const ResidualChannel& channel,
                                                          std::vector<std::vector<double>> residual) {
  for (std::size_t k = 0; k < residual.size(); ++k) {
    const RecordInput& record = input.records[channel.record_of[k]];
    // the blocks of one recording share the samples of the first
    const std::size_t samples = input.single ? input.records.front().fast_t_s.size() : record.fast_t_s.size();
    const std::vector<char> edge = edges_of(record, samples, input.range_N);
    std::size_t kept = 0;
    for (std::size_t j = 0; j < residual[k].size(); ++j)
      if (edge[channel.rows[k].row[j]] == 0) residual[k][kept++] = residual[k][j];
    residual[k].resize(kept);
  }
  return residual;
}

}  // namespace forcegate::diagnose
