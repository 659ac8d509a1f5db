#include "hil/diagnose/raw/mains_removal.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "hil/diagnose/raw/mains_line.h"

namespace forcegate::diagnose {

namespace {

using Eigen::Index;

constexpr double kWindow_s = 8.0;
constexpr std::size_t kFewest = 200;  // samples of a window
constexpr Index kSmooth = 4, kPerHarmonic = 8;

struct Samples {
  const std::vector<double>&t_s, &F_N;
  std::span<const std::uint8_t> bad;
  const std::vector<double>& U_V;
};

struct Window {
  std::size_t begin, end, stride = 1;  // of samples that are looked at
  Index rows() const { return static_cast<Index>((end - begin + stride - 1) / stride); }
};

std::vector<Window> windows_of(const std::vector<double>& t_s) {
  const std::size_t n = t_s.size();
  std::vector<Window> out;
  for (std::size_t begin = 0; begin < n;) {
    std::size_t end = std::min(n, begin + kFewest);
    while (end < n && t_s[end] - t_s[begin] < kWindow_s) ++end;
    if (n - end < kFewest) end = n;
    out.push_back({begin, end});
    begin = end;
  }
  return out;
}

// Those that the sampling leaves apart from the slow force, from half the rate and from each other.
std::vector<int> harmonics_apart(double mains_Hz, double rate_Hz) {
  constexpr double kApart_Hz = 1.0;
  const double first_Hz = folded_Hz(mains_Hz, rate_Hz), third_Hz = folded_Hz(3.0 * mains_Hz, rate_Hz);
  std::vector<int> out;
  if (first_Hz > kSlowestLine_Hz) out.push_back(1);
  if (third_Hz > kSlowestLine_Hz && 0.5 * rate_Hz - third_Hz > kApart_Hz && std::abs(third_Hz - first_Hz) > kApart_Hz) out.push_back(3);
  return out;
}

// What the line is at the samples of the window; what is beside it stays out.
Eigen::VectorXd line_in(const Samples& s, const Window& w, double frequency_Hz, const std::vector<int>& harmonics, const std::vector<double>& clock_s) {
  const Index n = w.rows(), columns = kSmooth + kPerHarmonic * static_cast<Index>(harmonics.size());
  const auto counts = [&](std::size_t i) { return s.bad[i] == 0 && std::isfinite(s.F_N[i]) && std::isfinite(s.U_V[i]); };
  double mean_N = 0.0, mean_V = 0.0, good = 0.0;
  for (std::size_t i = w.begin; i < w.end; i += w.stride)
    if (counts(i)) {
      mean_N += s.F_N[i];
      mean_V += s.U_V[i];
      good += 1.0;
    }
  if (good < 0.5 * static_cast<double>(kFewest)) return Eigen::VectorXd::Zero(n);
  mean_N /= good;
  mean_V /= good;
  double sd_N = 0.0;
  for (std::size_t i = w.begin; i < w.end; i += w.stride)
    if (counts(i)) sd_N += (s.F_N[i] - mean_N) * (s.F_N[i] - mean_N);
  sd_N = std::max(std::sqrt(sd_N / good), 1e-12);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, columns);
  Eigen::VectorXd y = Eigen::VectorXd::Zero(n);
  const double span_s = std::max(1e-9, clock_s[w.end - 1] - clock_s[w.begin]);
  for (std::size_t i = w.begin; i < w.end; i += w.stride) {
    if (!counts(i)) continue;
    const auto row = static_cast<Index>((i - w.begin) / w.stride);
    const double x = 2.0 * (clock_s[i] - clock_s[w.begin]) / span_s - 1.0, f = (s.F_N[i] - mean_N) / sd_N;
    Index c = 0;
    for (const double smooth : {1.0, x, 1.5 * x * x - 0.5, f}) A(row, c++) = smooth;
    for (const int h : harmonics) {
      const double phase = 2.0 * std::numbers::pi * h * frequency_Hz * clock_s[i];
      const double sine = std::sin(phase), cosine = std::cos(phase);
      for (const double with : {1.0, f, f * f - 1.0, x})
        for (const double wave : {sine, cosine}) A(row, c++) = with * wave;
    }
    y[row] = s.U_V[i] - mean_V;
  }
  // a force that stands still has no columns of its own: the ridge keeps them at zero
  Eigen::MatrixXd normal = A.transpose() * A;
  normal.diagonal().array() += 1e-6 * good;
  const Eigen::VectorXd strength = normal.ldlt().solve(A.transpose() * y);
  return A.rightCols(columns - kSmooth) * strength.tail(columns - kSmooth);
}

}  // namespace

double remove_mains_line(const std::vector<double>& t_s, const std::vector<double>& F_N, std::span<const std::uint8_t> bad, double mains_Hz,
                         double rate_Hz, std::vector<double>& U_V) {
  constexpr double kFurthest_Hz = 0.25, kStep_Hz = 0.05;
  constexpr std::size_t kWindows = 4, kSamples = 1500;  // that the search looks at
  const Samples samples{t_s, F_N, bad, U_V};
  const std::vector<Window> windows = windows_of(t_s);
  std::vector<Window> looked_at;
  for (std::size_t k = 0; k < windows.size(); k += (windows.size() + kWindows - 1) / kWindows) {
    looked_at.push_back(windows[k]);
    looked_at.back().stride = (windows[k].end - windows[k].begin + kSamples - 1) / kSamples;
  }
  // stamps that are written with few digits tell less than a clock that goes evenly
  std::vector<double> even_s(t_s.size());
  const double step_s = (t_s.back() - t_s.front()) / static_cast<double>(t_s.size() - 1);
  for (std::size_t i = 0; i < t_s.size(); ++i) even_s[i] = step_s * static_cast<double>(i);
  const std::vector<int> harmonics = harmonics_apart(mains_Hz, rate_Hz);
  double most = -1.0, frequency_Hz = mains_Hz;
  const std::vector<double>* clock_s = &t_s;
  for (const std::vector<double>* clock : std::initializer_list<const std::vector<double>*>{&t_s, &even_s})
    for (double off_Hz = -kFurthest_Hz; off_Hz < kFurthest_Hz + 0.5 * kStep_Hz; off_Hz += kStep_Hz) {
      double power = 0.0;
      for (const Window& w : looked_at)
        power += static_cast<double>(w.stride) * line_in(samples, w, mains_Hz + off_Hz, harmonics, *clock).squaredNorm();
      if (power <= most) continue;
      most = power;
      frequency_Hz = mains_Hz + off_Hz;
      clock_s = clock;
    }
  double sum = 0.0;
  for (const Window& w : windows) {
    const Eigen::VectorXd line = line_in(samples, w, frequency_Hz, harmonics, *clock_s);
    for (std::size_t i = w.begin; i < w.end; ++i) U_V[i] -= line[static_cast<Index>(i - w.begin)];
    sum += line.squaredNorm();
  }
  return sum / static_cast<double>(t_s.size());
}

}  // namespace forcegate::diagnose
