#include "hil/diagnose/choose/hold_growth.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hil/diagnose/raw/sample_noise.h"
#include "hil/model/states.h"
#include "hil/trace/static_line.h"

namespace forcegate::diagnose {

namespace {

constexpr double kShortest_s = 10.0, kFirst_s = 2.0, kWithin = 0.01;
constexpr std::size_t kFewestRows = 20;

struct Hold {
  double xx = 0.0, xy = 0.0;  // sums of the growth expected, and with the output, each about its mean in the hold
  double k() const { return xy / xx; }
};

struct Rows {
  std::size_t begin, end;
};

// Longest runs of rows whose forces span no more than `span_N`, one after the other.
std::vector<Rows> still_rows(const RecordInput& r, double span_N) {
  std::vector<Rows> out;
  std::size_t begin = 0;
  double low = 0.0, high = 0.0;
  const auto close = [&](std::size_t end) {
    if (end > begin && r.t_s[end - 1] - r.t_s[begin] >= kShortest_s) out.push_back({begin, end});
  };
  for (std::size_t i = 0; i < r.rows(); ++i) {
    const double F = r.F_N[i];
    if (r.ok[i] == 0 || !std::isfinite(F)) {
      close(i);
      begin = i + 1;
      continue;
    }
    if (i == begin) low = high = F;
    low = std::min(low, F), high = std::max(high, F);
    if (high - low <= span_N) continue;
    close(i);
    begin = i;
    low = high = F;
  }
  close(r.rows());
  return out;
}

// Growth by the load itself in a decade of time after a step, and what is left of it after unloading.
std::vector<double> growth_of(const RecordInput& r) {
  std::vector<double> tau_s, weight;
  for (double tau = 0.3; tau < 4000.0; tau *= std::sqrt(10.0)) tau_s.push_back(tau), weight.push_back(0.5);
  return spectrum_response(r, r.F_N, tau_s, weight, r.F_N.front());
}

// Volts per newton of the record at large.
double slope_of(const RecordInput& r) {
  StaticLine line;
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (r.ok[i] != 0) line.push(r.U_V[i], r.F_N[i]);
  return line.n() > 1.0 && line.variance_N2() > 0.0 ? line.covariance_VN() / line.variance_N2() : 0.0;
}

void add_holds(const RecordInput& r, double range_N, std::vector<Hold>& up, std::vector<Hold>& down) {
  constexpr double kRangeOfNoise = 7.0;  // what thousands of rows span
  const std::vector<Rows> still = still_rows(r, kWithin * range_N + kRangeOfNoise * white_noise(r.F_N));
  if (still.empty()) return;
  const double slope = slope_of(r);
  if (slope == 0.0) return;
  const std::vector<double> growth = growth_of(r);
  for (const Rows& rows : still) {
    std::size_t begin = rows.begin;
    while (begin < rows.end && r.t_s[begin] < r.t_s[rows.begin] + kFirst_s) ++begin;
    if (rows.end - begin < kFewestRows) continue;
    const auto n = static_cast<double>(rows.end - begin);
    double x = 0.0, y = 0.0;
    const auto residual = [&](std::size_t i) { return r.U_V[i] / slope - r.F_N[i]; };
    for (std::size_t i = begin; i < rows.end; ++i) x += growth[i] / n, y += residual(i) / n;
    Hold hold;
    for (std::size_t i = begin; i < rows.end; ++i) {
      hold.xx += (growth[i] - x) * (growth[i] - x);
      hold.xy += (growth[i] - x) * (residual(i) - y);
    }
    if (hold.xx > 0.0) (growth[rows.end - 1] >= growth[begin] ? up : down).push_back(hold);
  }
}

struct Common {
  double k = 0.0, error = 0.0, weight = 0.0;
};

Common common_of(const std::vector<Hold>& holds) {
  Common out;
  double xy = 0.0, square = 0.0;
  for (const Hold& h : holds) out.weight += h.xx, xy += h.xy;
  if (!(out.weight > 0.0)) return out;
  out.k = xy / out.weight;
  for (const Hold& h : holds) square += std::pow(h.xx * (h.k() - out.k), 2);
  const auto n = static_cast<double>(holds.size());
  out.error = n > 1.0 ? std::sqrt(square * n / (n - 1.0)) / out.weight : 0.0;
  return out;
}

}  // namespace

bool grows_in_holds(const CampaignInput& campaign) {
  constexpr std::size_t kFewest = 4;
  constexpr double kErrors = 5.0, kTells = 0.1;  // of all weight: a direction with less says nothing
  std::vector<Hold> up, down;
  for (const RecordInput& r : campaign.records)
    if (!r.dynamic && r.rows() > kFewestRows) add_holds(r, campaign.range_N, up, down);
  std::vector<Hold> all = up;
  all.insert(all.end(), down.begin(), down.end());
  if (all.size() < kFewest) return false;
  const Common common = common_of(all);
  if (!(common.k > kErrors * common.error)) return false;
  const auto agrees = [&](const std::vector<Hold>& holds) {
    const Common own = common_of(holds);
    return own.weight > kTells * common.weight && own.k > 0.5 * common.k;
  };
  return agrees(up) && agrees(down);
}

}  // namespace forcegate::diagnose
