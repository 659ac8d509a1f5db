#include "hil/diagnose/answer/coloured_noise.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <span>

#include "hil/base/quantile.h"
#include "hil/diagnose/answer/remainder.h"
#include "hil/diagnose/answer/window_power.h"
#include "hil/model/record_input.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kBlock = 8, kFewestBlocks = 25, kFewestRecords = 4;
constexpr double kHigh = 1.8, kLow = 0.55;     // RMS of a record over the median of all
constexpr double kFlat = 2.3, kPeaked = 3.7;   // median kurtosis; 3 of a normal distribution
constexpr double kBursts = 6.0;                // kurtosis of any record
constexpr double kFaster = 3.0;                // of the fastest record over the slowest
constexpr double kMost = 0.006;                // of the span
constexpr double kTone = 0.3;                  // of the power, at one frequency

struct Spread {
  double rms = 0.0, kurtosis = 0.0;
};

// Of the means of blocks of rows.
Spread of_block_means(const std::vector<double>& e) {
  double square = 0.0, fourth = 0.0, n = 0.0;
  for (std::size_t i = 0; i + kBlock <= e.size(); i += kBlock) {
    double mean = 0.0;
    for (std::size_t j = i; j < i + kBlock; ++j) mean += e[j] / static_cast<double>(kBlock);
    square += mean * mean;
    fourth += mean * mean * mean * mean;
    n += 1.0;
  }
  if (!(square > 0.0)) return {};
  return {std::sqrt(square / n), fourth * n / (square * square)};
}

// RMS of the means of neighbouring rows where the load (force, or how fast it moves) is large over that where it is small; 1 where they are
// the same.
double loaded_over_not(const CampaignInput& input, const ResidualChannel& channel, const std::vector<std::vector<double>>& residual,
                       std::vector<double> RecordInput::* load) {
  constexpr double kMuch = 0.8, kLittle = 0.5;  // quantiles
  std::vector<std::pair<double, double>> blocks;  // load and square
  for (std::size_t k = 0; k < residual.size(); ++k) {
    const RecordInput& r = input.records[channel.record_of[k]];
    const std::vector<std::size_t>& row = channel.rows[k].row;
    for (std::size_t i = 0; i + kBlock <= residual[k].size(); i += kBlock) {
      double most = 0.0, mean = 0.0;
      for (std::size_t j = i; j < i + kBlock; ++j) {
        most = std::max(most, std::abs((r.*load)[row[j]]));
        mean += residual[k][j];
      }
      blocks.emplace_back(most, mean * mean);
    }
  }
  std::ranges::sort(blocks);
  const auto mean = [&](double from, double to) {
    const double n = static_cast<double>(blocks.size());
    const auto begin = static_cast<std::size_t>(from * n), end = static_cast<std::size_t>(to * n);
    double sum = 0.0;
    for (std::size_t k = begin; k < end; ++k) sum += blocks[k].second;
    return end > begin ? sum / static_cast<double>(end - begin) : 0.0;
  };
  const double little = mean(0.0, kLittle);
  return little > 0.0 ? std::sqrt(mean(kMuch, 1.0) / little) : 0.0;
}

double rms_rate(const RecordInput& record) {
  double square = 0.0;
  for (const double v : record.rate_N_per_s) square += v * v;
  return std::sqrt(square / static_cast<double>(std::max<std::size_t>(1, record.rate_N_per_s.size())));
}

// Share of the power at one frequency and its neighbours, where it is highest, above the slowest waves of a window; median over all windows.
double share_of_tone(const std::vector<std::vector<double>>& residual) {
  constexpr std::size_t kSlowest = 4;
  std::vector<double> share;
  for (const std::vector<double>& e : residual)
    for (std::size_t from = 0; from + kPowerWindow <= e.size(); from += kPowerWindow) {
      const auto power = window_power(std::span(e).subspan(from, kPowerWindow));
      const double total = std::accumulate(power.begin(), power.end(), 0.0);
      double highest = 0.0;
      for (std::size_t k = kSlowest; k + 1 < power.size(); ++k) highest = std::max(highest, power[k - 1] + power[k] + power[k + 1]);
      if (total > 0.0) share.push_back(highest / total);
    }
  return share.empty() ? 0.0 : quantile(std::move(share), 0.5);
}

}  // namespace

bool is_coloured_noise(const CampaignInput& input, const ResidualChannel& channel, const std::vector<std::vector<double>>& residual,
                       const std::vector<ResidualMap>& maps) {
  // the output holds the noise itself: where the force keeps still, the two go together
  std::vector<ResidualMap> others;
  std::copy_if(maps.begin(), maps.end(), std::back_inserter(others), [](const ResidualMap& m) { return m.coordinate != "output"; });
  if (depends_on(others) != std::vector<std::string>{"time"}) return false;
  std::vector<double> rms, kurtosis;
  double slowest = 1e300, fastest = 0.0;
  for (std::size_t k = 0; k < residual.size(); ++k) {
    if (residual[k].size() < kFewestBlocks * kBlock) continue;
    const Spread spread = of_block_means(residual[k]);
    rms.push_back(spread.rms);
    kurtosis.push_back(spread.kurtosis);
    const double rate = rms_rate(input.records[channel.record_of[k]]);
    slowest = std::min(slowest, rate);
    fastest = std::max(fastest, rate);
  }
  if (rms.size() < kFewestRecords) return false;
  const auto differs = [&](std::vector<double> RecordInput::* load) {
    const double ratio = loaded_over_not(input, channel, residual, load);
    return ratio > kHigh || ratio < kLow;
  };
  if (differs(&RecordInput::F_N)) return false;
  if (input.single) {
    if (differs(&RecordInput::rate_N_per_s)) return false;
  } else if (fastest < kFaster * slowest) {
    return false;
  }
  const double typical = quantile(rms, 0.5), form = quantile(kurtosis, 0.5);
  return typical < kMost * channel.scale && *std::max_element(rms.begin(), rms.end()) < kHigh * typical &&
         *std::min_element(rms.begin(), rms.end()) > kLow * typical && form > kFlat && form < kPeaked &&
         *std::max_element(kurtosis.begin(), kurtosis.end()) < kBursts && share_of_tone(residual) < kTone;
}

}  // namespace forcegate::diagnose
