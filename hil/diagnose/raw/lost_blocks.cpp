#include "hil/diagnose/raw/lost_blocks.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/base/parallel.h"
#include "hil/base/quantile.h"
#include "hil/model/record_input.h"
#include "hil/model/states.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kWindows = 64, kRowsOfWindow = 100, kFewestWindows = 8;

struct Window {
  std::size_t begin = 0, end = 0;  // rows
  double middle_s = 0.0;           // in the record's time
  double late_s = 0.0, variance_s2 = std::numeric_limits<double>::infinity();
  double speed_N_per_s = 0.0;      // RMS
};

// By how much the output is behind `F`, which goes as fast as the record's force.
void measure(const RecordInput& r, const std::vector<double>& F, Window& w) {
  const std::vector<double>& rate = r.rate_N_per_s;
  using Row = Eigen::Vector4d;
  Eigen::Matrix4d M = Eigen::Matrix4d::Zero();
  double n = 0.0;
  for (std::size_t i = w.begin; i < w.end; ++i) {
    if (r.ok[i] == 0 || !std::isfinite(rate[i]) || !std::isfinite(F[i])) continue;
    const Row x(1.0, F[i], rate[i], r.U_V[i]);
    M += x * x.transpose();
    n += 1.0;
  }
  constexpr double kFewest = 20.0;
  w.variance_s2 = std::numeric_limits<double>::infinity();
  if (n < kFewest) return;
  w.speed_N_per_s = std::sqrt(M(2, 2) / n);
  const Eigen::Vector3d size = M.diagonal().head<3>().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d A = size.asDiagonal() * M.topLeftCorner<3, 3>() * size.asDiagonal();
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(A);
  if (!(lu.rcond() > 1e-9)) return;
  const Eigen::Matrix3d inverse = lu.inverse();
  const Eigen::Vector3d y = size.asDiagonal() * M.col(3).head<3>(), c = inverse * y;
  const double gain = c[1] * size[1], left = std::max(0.0, M(3, 3) - c.dot(y)) / (n - 3.0);
  if (gain == 0.0) return;
  // of a sine the two columns have a part of it each, and their ratio is the tangent of its phase
  const double swing_N = std::sqrt(std::max(0.0, M(1, 1) / n - std::pow(M(0, 1) / n, 2))), per_s = swing_N > 0.0 ? w.speed_N_per_s / swing_N : 0.0;
  const double tangent = -per_s * c[2] * size[2] / gain;
  if (!(per_s > 0.0)) return;
  w.late_s = std::atan(tangent) / per_s;
  w.variance_s2 = left * inverse(2, 2) * std::pow(size[2] / gain / (1.0 + tangent * tangent), 2);
}

std::vector<Window> windows_of(const RecordInput& r) {
  const std::size_t n = std::min(kWindows, r.rows() / kRowsOfWindow);
  std::vector<Window> out;
  if (n < kFewestWindows) return out;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t begin = r.rows() * k / n, end = r.rows() * (k + 1) / n;
    out.push_back({begin, end, 0.5 * (r.t_s[begin] + r.t_s[end - 1])});
  }
  return out;
}

struct Slope {
  double value = 0.0, u = 0.0;  // seconds a second
  bool plain() const { return std::abs(value) > 4.0 * u; }
};

// Of the lateness from window to window: the median, which steps leave alone.
Slope typical_slope(const std::vector<Window>& windows) {
  constexpr double kOfMedian = 1.25, kOfQuartiles = 1.35;
  std::vector<double> slope;
  for (std::size_t k = 1; k < windows.size(); ++k)
    if (std::isfinite(windows[k].variance_s2 + windows[k - 1].variance_s2))
      slope.push_back((windows[k].late_s - windows[k - 1].late_s) / (windows[k].middle_s - windows[k - 1].middle_s));
  if (slope.empty()) return {};
  const auto [low, high] = quantiles(slope, 0.25, 0.75);
  const double n = static_cast<double>(slope.size());
  return {quantile(std::move(slope), 0.5), kOfMedian * (high - low) / kOfQuartiles / std::sqrt(n)};
}

void take_off(std::vector<Window>& windows, double slope) {
  for (Window& w : windows) w.late_s -= slope * w.middle_s;
}

// Windows differ by more than their noise: by half of what the typical neighbours do.
void widen(std::vector<Window>& windows, double row_step_s) {
  constexpr double kMedianOfChi2 = 0.455, kOfRow = 0.002;
  for (Window& w : windows) w.variance_s2 += std::pow(kOfRow * row_step_s, 2);
  std::vector<double> ratio;
  for (std::size_t k = 1; k < windows.size(); ++k)
    if (const double v = windows[k].variance_s2 + windows[k - 1].variance_s2; std::isfinite(v)) ratio.push_back(std::pow(windows[k].late_s - windows[k - 1].late_s, 2) / v);
  if (ratio.empty()) return;
  const double wider = std::max(1.0, quantile(ratio, 0.5) / kMedianOfChi2);
  for (Window& w : windows) w.variance_s2 *= wider;
}

struct Level {
  std::size_t begin = 0, end = 0;  // windows
  double late_s = 0.0;
};

struct Staircase {
  std::vector<Level> levels;
  double misfit = 0.0;  // chi squared
  double slope = 0.0;   // seconds a second, of two clocks that run apart beside it
};

// The window between two levels may belong to neither: the step is in it.
Staircase staircase(const std::vector<Window>& w) {
  constexpr double kPrice = 40.0;  // chi squared
  constexpr std::size_t kShortest = 2;
  const std::size_t n = w.size();
  std::vector<double> one(n + 1, 0.0), x(n + 1, 0.0), xx(n + 1, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    const double weight = std::isfinite(w[k].variance_s2) ? 1.0 / w[k].variance_s2 : 0.0;
    one[k + 1] = one[k] + weight;
    x[k + 1] = x[k] + weight * w[k].late_s;
    xx[k + 1] = xx[k] + weight * w[k].late_s * w[k].late_s;
  }
  const auto cost = [&](std::size_t a, std::size_t b) {
    const double weight = one[b] - one[a], mean = weight > 0.0 ? (x[b] - x[a]) / weight : 0.0;
    return std::max(0.0, xx[b] - xx[a] - weight * mean * mean);
  };
  std::vector<double> best(n + 1, 1e300);
  std::vector<std::size_t> from(n + 1, 0), end_before(n + 1, 0);
  best[0] = 0.0;
  for (std::size_t b = kShortest; b <= n; ++b)
    for (std::size_t a = 0; a + kShortest <= b; ++a) {
      for (const std::size_t skipped : {0UL, 1UL}) {
        if (a < skipped || (skipped > 0 && a == skipped)) continue;
        const std::size_t before = a - skipped;
        const double sum = best[before] + cost(a, b) + (a > 0 ? kPrice : 0.0);
        if (sum < best[b]) best[b] = sum, from[b] = a, end_before[b] = before;
      }
    }
  Staircase out;
  out.misfit = best[n];
  for (std::size_t b = n; b > 0; b = end_before[b]) {
    const double weight = one[b] - one[from[b]];
    out.levels.push_back({from[b], b, weight > 0.0 ? (x[b] - x[from[b]]) / weight : 0.0});
    if (from[b] == 0) break;
  }
  std::ranges::reverse(out.levels);
  out.misfit -= kPrice * static_cast<double>(out.levels.size() - 1);
  return out;
}

// One slope within all levels.
Slope slope_within(const std::vector<Window>& w, const Staircase& stairs) {
  double tt = 0.0, ts = 0.0;
  for (const Level& level : stairs.levels) {
    double weight = 0.0, t = 0.0;
    for (std::size_t k = level.begin; k < level.end; ++k)
      if (std::isfinite(w[k].variance_s2)) weight += 1.0 / w[k].variance_s2, t += w[k].middle_s / w[k].variance_s2;
    for (std::size_t k = level.begin; k < level.end; ++k)
      if (std::isfinite(w[k].variance_s2)) {
        const double since = w[k].middle_s - t / weight;
        tt += since * since / w[k].variance_s2;
        ts += since * (w[k].late_s - level.late_s) / w[k].variance_s2;
      }
  }
  return tt > 0.0 ? Slope{ts / tt, 1.0 / std::sqrt(tt)} : Slope{};
}

// What a smooth course leaves: chi squared about a polynomial of the third degree.
double left_by_curve(const std::vector<Window>& w) {
  Eigen::Matrix<double, 5, 5> M = Eigen::Matrix<double, 5, 5>::Zero();
  for (std::size_t k = 0; k < w.size(); ++k) {
    if (!std::isfinite(w[k].variance_s2)) continue;
    const double u = 2.0 * static_cast<double>(k) / static_cast<double>(w.size()) - 1.0;
    Eigen::Matrix<double, 5, 1> row;
    row << 1.0, u, u * u, u * u * u, w[k].late_s;
    M += row * row.transpose() / w[k].variance_s2;
  }
  const Eigen::Vector4d c = M.topLeftCorner<4, 4>().ldlt().solve(M.col(4).head<4>());
  return std::max(0.0, M(4, 4) - c.dot(M.col(4).head<4>()));
}

// The load goes on as before: a lag, or a loop, is no later than it was.
bool same_speed(const std::vector<Window>& w, const Level& before, const Level& after) {
  constexpr double kAlike = 1.4;
  const auto speed = [&](const Level& level) {
    double sum = 0.0, n = 0.0;
    for (std::size_t k = level.begin; k < level.end; ++k)
      if (std::isfinite(w[k].variance_s2)) sum += w[k].speed_N_per_s, n += 1.0;
    return n > 0.0 ? sum / n : 0.0;
  };
  const double a = speed(before), b = speed(after);
  return a < kAlike * b && b < kAlike * a;
}

// Where between two levels the later one begins: the row at which changing from one to the other leaves least.
std::size_t first_row_of(const RecordInput& r, const std::vector<Window>& w, double slope, const Level& before, const Level& after) {
  const auto late_F = [&](std::size_t i, double level_s) { return r.F_N[i] - (level_s + slope * r.t_s[i]) * r.rate_N_per_s[i]; };
  const std::size_t begin = w[before.end - 1].begin, end = w[after.begin].end;
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  for (std::size_t i = begin; i < end; ++i) {
    if (r.ok[i] == 0 || !std::isfinite(r.rate_N_per_s[i])) continue;
    const Eigen::Vector3d x(1.0, late_F(i, 0.5 * (before.late_s + after.late_s)), r.U_V[i]);
    M += x * x.transpose();
  }
  const double det = M(0, 0) * M(1, 1) - M(0, 1) * M(0, 1);
  if (!(det > 1e-12 * M(0, 0) * M(1, 1))) return w[after.begin].begin;
  const double gain = (M(0, 0) * M(1, 2) - M(0, 1) * M(0, 2)) / det, zero = (M(0, 2) - gain * M(0, 1)) / M(0, 0);
  const auto left = [&](std::size_t i, double late_s) {
    return r.ok[i] != 0 && std::isfinite(r.rate_N_per_s[i]) ? std::pow(r.U_V[i] - zero - gain * late_F(i, late_s), 2) : 0.0;
  };
  double sum = 0.0, least = 0.0;
  std::size_t at = begin;
  for (std::size_t i = begin; i < end; ++i) {
    sum += left(i, before.late_s) - left(i, after.late_s);
    if (sum < least) least = sum, at = i + 1;
  }
  return at;
}

// The staircase beside the slope that two clocks may have; the slope is taken off the windows.
Staircase staircase_beside_slope(std::vector<Window>& windows, double row_step_s) {
  constexpr int kRounds = 3;
  const Slope typical = typical_slope(windows);
  double slope = typical.plain() ? typical.value : 0.0;
  take_off(windows, slope);
  widen(windows, row_step_s);
  Staircase out = staircase(windows);
  for (int round = 0; round < kRounds; ++round) {
    const Slope more = slope_within(windows, out);
    if (!more.plain()) break;
    take_off(windows, more.value);
    slope += more.value;
    out = staircase(windows);
  }
  out.slope = slope;
  return out;
}

// Steps that go one way under a load that goes on as before, and no smooth course that is cut into some.
bool is_plain(const Staircase& stairs, const std::vector<Window>& windows) {
  constexpr double kPlainer = 0.3;  // of what a smooth course leaves
  const std::vector<Level>& levels = stairs.levels;
  if (levels.size() < 2) return false;
  const double freedom = static_cast<double>(windows.size() - levels.size());
  if (stairs.misfit + freedom > kPlainer * (left_by_curve(windows) + freedom)) return false;
  const double up = levels[1].late_s - levels[0].late_s;
  for (std::size_t k = 1; k < levels.size(); ++k)
    if ((levels[k].late_s - levels[k - 1].late_s) * up <= 0.0 || !same_speed(windows, levels[k - 1], levels[k])) return false;
  return true;
}

// A record's staircase, `blocks` in seconds; empty: it shows none.
std::vector<LostBlocks> steps_of(const RecordInput& of) {
  constexpr int kRounds = 2;
  std::vector<Window> windows = windows_of(of);
  if (windows.empty() || of.fast_F_N.empty()) return {};
  for (Window& w : windows) measure(of, of.F_N, w);
  const Staircase stairs = staircase_beside_slope(windows, of.row_step_s);
  if (!is_plain(stairs, windows)) return {};
  const std::vector<Level>& levels = stairs.levels;
  RecordInput r = of;
  r.wanted.clear();
  r.lost_blocks.clear();
  for (std::size_t k = 1; k < levels.size(); ++k)
    r.lost_blocks.push_back({of.t_s[std::min(of.rows() - 1, first_row_of(of, windows, stairs.slope, levels[k - 1], levels[k]))], levels[k].late_s - levels[0].late_s});
  // a rate is the force's change over a shift that is small: what is left of it on the force as late as found
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<double> F = rows_behind_lost_blocks(r, 1.0);
    for (std::size_t k = 1; k < levels.size(); ++k) {
      double sum = 0.0, weight = 0.0;
      for (std::size_t j = levels[k].begin; j < levels[k].end; ++j) {
        Window w = windows[j];
        measure(r, F, w);
        if (!std::isfinite(w.variance_s2)) continue;
        sum += (w.late_s - stairs.slope * w.middle_s - levels[0].late_s) / w.variance_s2;
        weight += 1.0 / w.variance_s2;
      }
      if (weight > 0.0) r.lost_blocks[k - 1].blocks += sum / weight;
    }
  }
  return r.lost_blocks;
}

using StepsOfRecords = std::vector<std::vector<LostBlocks>>;

double size_of(const std::vector<LostBlocks>& record, std::size_t k) { return record[k].blocks - (k > 0 ? record[k - 1].blocks : 0.0); }

double typical_step(const StepsOfRecords& found) {
  std::vector<double> size;
  for (const auto& record : found)
    for (std::size_t k = 0; k < record.size(); ++k) size.push_back(size_of(record, k));
  return size.empty() ? 0.0 : quantile(size, 0.5);
}

// What is far smaller than a block is none.
void drop_slight(double block_s, StepsOfRecords& found) {
  constexpr double kSlight = 0.3;
  for (auto& record : found)
    for (std::size_t k = 0; k < record.size();)
      if (std::abs(size_of(record, k)) < kSlight * std::abs(block_s)) record.erase(record.begin() + static_cast<std::ptrdiff_t>(k));
      else ++k;
}

// A buffer that runs over does so again and again, and at the same times of every record: those of the record that shows most of them, if all
// others agree; else none.
std::vector<double> common_times_s(const StepsOfRecords& found) {
  constexpr double kSame_s = 2.0;
  constexpr std::ptrdiff_t kFewestRecords = 2;
  if (std::ranges::count_if(found, [](const auto& record) { return !record.empty(); }) < kFewestRecords) return {};
  std::vector<double> out;
  for (const LostBlocks& step : *std::ranges::max_element(found, {}, &std::vector<LostBlocks>::size)) out.push_back(step.from_s);
  const auto is_one = [&](const LostBlocks& step) { return std::ranges::any_of(out, [&](double at_s) { return std::abs(step.from_s - at_s) < kSame_s; }); };
  return std::ranges::all_of(found, [&](const auto& record) { return std::ranges::all_of(record, is_one); }) ? out : std::vector<double>{};
}

}  // namespace

void find_lost_blocks(CampaignInput& campaign, unsigned threads) {
  StepsOfRecords found(campaign.records.size());
  parallel_for(found.size(), threads, [&](std::size_t k) { found[k] = steps_of(campaign.records[k]); });
  drop_slight(typical_step(found), found);
  const double block_s = typical_step(found);
  if (block_s == 0.0) return;
  for (const auto& record : found)
    for (std::size_t k = 0; k < record.size(); ++k)
      if (size_of(record, k) * block_s <= 0.0) return;
  campaign.block_s = block_s;
  const std::vector<double> common_s = common_times_s(found);
  for (std::size_t k = 0; k < found.size(); ++k) {
    RecordInput& r = campaign.records[k];
    for (LostBlocks& step : found[k]) step.blocks /= block_s;
    r.lost_blocks = std::move(found[k]);
    if (common_s.empty()) continue;
    r.lost_blocks.clear();
    for (const double at_s : common_s)
      if (at_s < r.duration_s) r.lost_blocks.push_back({at_s, 1.0 + static_cast<double>(r.lost_blocks.size())});
  }
}

}  // namespace forcegate::diagnose
