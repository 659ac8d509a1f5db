#include "hil/diagnose/raw/reference_scatter.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "hil/base/quantile.h"

namespace forcegate::diagnose {

namespace {

struct Window {
  double scatter_N, moves_N, moves_V;  // standard deviations: of F beside U, its slope and a parabola, of F, of U and what comes of it
  double step_N, largest_step_N;       // RMS from one sample of F to the next; the largest one
  double free_N2, shared_NV;           // beside a parabola: variance of F, covariance of F and U
  std::size_t samples;
  double of_noise_U;                   // variance that a unit of the output's noise brings into the scatter, N^2/V^2
  std::size_t number;
  double mean_V;
};

double deviation_of(std::span<const double> x) {
  double sum = 0.0, square = 0.0;
  for (const double v : x) sum += v - x[0], square += (v - x[0]) * (v - x[0]);
  const double n = static_cast<double>(x.size());
  return std::sqrt(std::max(0.0, square / n - sum / n * (sum / n)));
}

// All of them, spread evenly where they are many, or those of the numbers `only`. A late output shows a load that begins at the end of a window only
// after it: whether it stands still is asked of half a window more.
std::vector<Window> windows_of(std::span<const double> t_s, std::span<const double> F_N, std::span<const double> U_V, double window_s,
                               std::span<const std::size_t> only = {}) {
  constexpr std::size_t kFewestSamples = 24, kMostWindows = 400, kFewestWindows = 8;
  std::vector<Window> out;
  const std::size_t n = std::min({t_s.size(), F_N.size(), U_V.size()});
  if (n < kFewestSamples * kFewestWindows) return out;
  const double step = (t_s[n - 1] - t_s[0]) / static_cast<double>(n - 1);
  const std::size_t length = std::max(kFewestSamples, static_cast<std::size_t>(std::max(0.0, window_s / std::max(step, 1e-9))));
  const std::size_t windows = n / length, stride = std::max<std::size_t>(1, windows / kMostWindows);
  // the place in the window is the same in all of them
  Eigen::Matrix3d places = Eigen::Matrix3d::Zero();
  std::vector<double> place;
  place.reserve(length);
  for (std::size_t k = 0; k < length; ++k) {
    const double x = 2.0 * static_cast<double>(k) / static_cast<double>(length - 1) - 1.0;
    const Eigen::Vector3d v(1.0, x, x * x);
    places += v * v.transpose();
    place.push_back(x);
  }
  const auto add = [&](std::size_t w) {
    // places, U, its slope (a late reference does not scatter), F
    Eigen::Matrix3d with = Eigen::Matrix3d::Zero(), among = with;
    double steps = 0.0, largest = 0.0;
    for (std::size_t k = 0; k < length; ++k) {
      const std::size_t i = w * length + k;
      const Eigen::Vector3d v(1.0, place[k], place[k] * place[k]);
      const Eigen::Vector3d x(U_V[i], 0.5 * (U_V[std::min(i + 1, n - 1)] - U_V[i > 0 ? i - 1 : 0]), F_N[i]);
      with += v * x.transpose();
      among += x * x.transpose();
      if (k == 0) continue;
      const double step_N = F_N[i] - F_N[i - 1];
      steps += step_N * step_N;
      largest = std::max(largest, std::abs(step_N));
    }
    // a missing sample is missing in these sums
    if (!among.allFinite()) return;
    const double samples = static_cast<double>(length), mean_U = with(0, 0) / samples, mean_F = with(0, 2) / samples;
    const double moves_V = deviation_of(U_V.subspan(w * length, std::min(length + length / 2, n - w * length)));
    const double moves_N = std::sqrt(std::max(0.0, among(2, 2) / samples - mean_F * mean_F));
    Eigen::Matrix<double, 6, 6> M;
    M << places, with, with.transpose(), among;
    // U may stand still to the last code: its share is then nothing
    for (const int j : {3, 4}) M(j, j) += 1e-12 * (1.0 + M(j, j));
    const Eigen::Matrix<double, 5, 1> c = M.topLeftCorner<5, 5>().ldlt().solve(M.topRightCorner<5, 1>());
    const double left = std::max(0.0, M(5, 5) - c.dot(M.topRightCorner<5, 1>()));
    const Eigen::Matrix3d beside = (among - with.transpose() * places.ldlt().solve(with)) / (samples - 3.0);
    out.push_back({std::sqrt(left / (samples - 5.0)), moves_N, moves_V, std::sqrt(steps / (samples - 1.0)), largest, beside(2, 2), beside(0, 2), length, c[3] * c[3] + 0.5 * c[4] * c[4], w, mean_U});
  };
  if (only.empty())
    for (std::size_t w = 0; w < windows; w += stride) add(w);
  for (const std::size_t w : only) add(w);
  return out;
}

constexpr double kWindow_s = 0.25, kStillWindow_s = 0.5;

// A record of a second has shorter windows rather than too few of them.
double window_in_s(std::span<const double> t_s, double usual_s) {
  constexpr double kWindows = 16.0;
  return t_s.empty() ? usual_s : std::min(usual_s, (t_s.back() - t_s.front()) / kWindows);
}

// The output's own noise hides from a regression a force that moves less than that; the covariance it leaves alone.
double moved_N2(double shared_NV, const OutputFacts& output) { return std::max(0.0, shared_NV / output.gain_V_per_N); }

// One step holds most of what F does there, and the output would have shown it: a load that a late output has not seen yet.
bool is_step_of_load(const Window& w, const OutputFacts& output) {
  constexpr double kMost = 0.6, kShown = 0.01;  // of the mean square step; of the range
  const double steps_N2 = w.step_N * w.step_N * static_cast<double>(w.samples - 1);
  return w.largest_step_N * w.largest_step_N > kMost * steps_N2 && std::abs(output.gain_V_per_N) * w.largest_step_N > kShown * output.range_V;
}

// Those in which, as they were recorded, U stands still and F is noise.
std::vector<Window> still_among(std::vector<Window> recorded, const OutputFacts& output) {
  constexpr double kStill = 0.01;
  // noise steps by 1.4 of itself, coloured noise by some less; a force that moves smoothly while the output stands still has met a rail
  constexpr double kLeastStep = 0.3;
  std::erase_if(recorded, [&](const Window& w) {
    return !(w.moves_V < kStill * output.range_V && w.step_N > kLeastStep * w.scatter_N && !is_step_of_load(w, output));
  });
  return recorded;
}

// RMS of F in windows in which U stands still; 0: too few of them.
double noise_of(std::vector<Window> still, const OutputFacts& output) {
  constexpr double kKept = 0.95;
  constexpr std::size_t kFewest = 10;
  if (still.size() < kFewest) return 0.0;
  std::sort(still.begin(), still.end(), [](const Window& a, const Window& b) { return a.scatter_N < b.scatter_N; });
  still.resize(static_cast<std::size_t>(kKept * static_cast<double>(still.size())));
  double beside_U = 0.0, free = 0.0, shared = 0.0;
  for (const Window& w : still) {
    beside_U += w.scatter_N * w.scatter_N / static_cast<double>(still.size());
    free += w.free_N2 / static_cast<double>(still.size());
    shared += w.shared_NV / static_cast<double>(still.size());
  }
  return std::sqrt(std::clamp(free - moved_N2(shared, output), 0.0, beside_U));
}

}  // namespace

double left_where_still(std::span<const double> t_s, std::span<const double> recorded_N, std::span<const double> smoothed_N,
                        std::span<const double> U_V, const OutputFacts& output) {
  double out = 0.0;
  for (const double window_s : {kStillWindow_s, 2.0}) {
    std::vector<std::size_t> still;
    for (const Window& w : still_among(windows_of(t_s, recorded_N, U_V, window_s), output)) still.push_back(w.number);
    if (!still.empty()) out = std::max(out, noise_of(windows_of(t_s, smoothed_N, U_V, window_s, still), output));
  }
  return out;
}

// F beside U, U's own noise and what they share left out.
double alone_in(const Window& w, const OutputFacts& output) {
  const double beside_U = w.scatter_N * w.scatter_N - w.of_noise_U * output.noise_V * output.noise_V;
  return std::sqrt(std::max(0.0, std::min(beside_U, w.free_N2 - moved_N2(w.shared_NV, output))));
}

// Its lowest level may be a dead zone or a floor, where a force that moves moves nothing.
void find_bursts(const std::vector<Window>& windows, const OutputFacts& output, double lowest_V, ReferenceScatter& out) {
  constexpr double kStill = 0.01, kAboveLowest = 0.02;  // of the range
  constexpr double kRestless = 5.0, kUsual = 0.3, kLeastShare = 0.1, kMostShare = 0.6;
  constexpr double kLeastStep = 1.1;  // white noise steps by 1.4 of itself; a knock that rings by less
  constexpr std::size_t kFewestWindows = 20, kFewestBursts = 5;
  std::vector<double> alone, all;
  for (const Window& w : windows) {
    if (!(w.moves_V < kStill * output.range_V && w.mean_V > lowest_V + kAboveLowest * output.range_V) || is_step_of_load(w, output)) continue;
    all.push_back(alone_in(w, output));
    alone.push_back(w.step_N > kLeastStep * w.scatter_N ? all.back() : 0.0);
  }
  if (all.size() < kFewestWindows) {
    out.burst_N = std::numeric_limits<double>::quiet_NaN();
    return;
  }
  const double usual_N = std::max(quantile(all, kUsual), 0.5 * output.step_N);
  double square = 0.0, n = 0.0;
  for (const double x : alone)
    if (x > kRestless * usual_N) square += x * x, n += 1.0;
  const double share = n / static_cast<double>(all.size());
  if (n < static_cast<double>(kFewestBursts) || share < kLeastShare || share > kMostShare) return;
  out.burst_N = std::sqrt(square / n);
  out.between_bursts_N = usual_N;
  out.burst_share = share;
}

ReferenceScatter reference_scatter(std::span<const double> t_s, std::span<const double> F_N, std::span<const double> U_V, const OutputFacts& output) {
  // beyond kSlow of the record's span what the output does besides following the force would be laid at the reference's door
  constexpr double kSlow = 0.1;
  constexpr std::size_t kFewest = 8;
  ReferenceScatter out;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double F : F_N) {
    low = std::min(low, F);
    high = std::max(high, F);
  }
  const auto lower_quartile = [](std::vector<double> x) {
    if (x.size() < kFewest) return 0.0;
    const auto quarter = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 4);
    std::nth_element(x.begin(), quarter, x.end());
    return *quarter;
  };
  std::vector<double> scatter, alone;
  const std::vector<Window> windows = windows_of(t_s, F_N, U_V, window_in_s(t_s, kWindow_s));
  for (const Window& w : windows) {
    if (w.moves_N < kSlow * (high - low)) scatter.push_back(w.scatter_N);
    alone.push_back(alone_in(w, output));
  }
  double lowest_V = std::numeric_limits<double>::infinity();
  for (const double U : U_V) lowest_V = std::min(lowest_V, U);
  find_bursts(windows, output, lowest_V, out);
  out.quartile_N = lower_quartile(std::move(scatter));
  out.alone_N = lower_quartile(std::move(alone));
  out.still_N = noise_of(still_among(windows_of(t_s, F_N, U_V, window_in_s(t_s, kStillWindow_s)), output), output);
  return out;
}

}  // namespace forcegate::diagnose
