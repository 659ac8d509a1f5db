#include "hil/diagnose/raw/edges.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "hil/base/quantile.h"
#include "hil/trace/trace.h"

namespace forcegate::diagnose {

namespace {

constexpr double kHalf_s = 0.03, kRunUp_s = 0.25;
constexpr std::size_t kFewestOfHalf = 8, kMostOfHalf = 150, kMostOfRunUp = 1000, kMostWindows = 40;

// Energy of the force's second difference over five samples, of means of three.
std::vector<double> turn_of(const std::vector<double>& F) {
  const std::size_t n = F.size();
  std::vector<double> square(n, 0.0), out(n, 0.0);
  for (std::size_t i = 2; i + 2 < n; ++i) {
    const double d = (F[i + 2] - F[i + 1] - F[i - 1] + F[i - 2]) / 3.0;
    square[i] = std::isfinite(d) ? d * d : 0.0;
  }
  for (std::size_t i = 2; i + 2 < n; ++i) out[i] = square[i - 2] + square[i - 1] + square[i] + square[i + 1] + square[i + 2];
  return out;
}

// Whether every other sample tells the ones between: an edge within a sample or two ran some way that nobody saw.
bool is_resolved(const std::vector<double>& F, std::size_t begin, std::size_t end, double noise_F_N) {
  constexpr double kUntold = 0.12, kOfNoise = 2.5;  // of the square of the differences; what the cubic makes of a variance is 1.6
  double untold = 0.0, differences = 0.0;
  for (std::size_t k = begin + 3; k + 3 < end; ++k) {
    const double told = (9.0 * (F[k - 1] + F[k + 1]) - (F[k - 3] + F[k + 3])) / 16.0, step = F[k + 1] - F[k];
    untold += (F[k] - told) * (F[k] - told);
    differences += step * step;
  }
  return untold < kUntold * differences + kOfNoise * noise_F_N * noise_F_N * static_cast<double>(end - begin);
}

// Whole: every sample from `begin` to `end` is there, on an even clock.
class WholeStretches {
 public:
  WholeStretches(const std::vector<double>& t, const std::vector<double>& F, const std::vector<double>& U, std::span<const std::uint8_t> bad, double step_s) {
    constexpr double kEven = 1.5;
    faults_.assign(t.size() + 1, 0);
    for (std::size_t i = 0; i < t.size(); ++i) {
      const bool is_bad = !std::isfinite(F[i]) || !std::isfinite(U[i]) || (i < bad.size() && bad[i] != 0) || (i > 0 && t[i] - t[i - 1] > kEven * step_s);
      faults_[i + 1] = faults_[i] + (is_bad ? 1 : 0);
    }
  }
  bool is_whole(std::size_t begin, std::size_t end) const { return faults_[end] == faults_[begin]; }

 private:
  std::vector<std::uint32_t> faults_;
};

}  // namespace

Edges edges_of(const Record& record, const std::vector<double>& recorded_N, const RecordHealth& health, std::span<const std::uint8_t> bad) {
  constexpr double kAboveNoise = 9.0, kOfNoise = 20.0 / 9.0;  // energy; five times the 4/9 that differences of means leave of a variance
  Edges out;
  const Channel *F = record.trace.find("F_ref"), *U = record.trace.find("U");
  if (F == nullptr || U == nullptr || F->time_base != U->time_base) return out;
  const std::vector<double>& t = record.trace.time_bases[F->time_base].t_s;
  if (t.size() < 4 * kFewestOfHalf || recorded_N.size() != t.size() || U->value.size() != t.size()) return out;
  std::vector<double> steps(t.size() - 1);
  std::transform(t.begin() + 1, t.end(), t.begin(), steps.begin(), std::minus<>());
  const double step_s = median(std::move(steps));
  if (!(step_s > 0.0)) return out;
  const auto samples = [&](double s, std::size_t least, std::size_t most) { return std::clamp(static_cast<std::size_t>(std::lround(s / step_s)), least, most); };
  const std::size_t half = samples(kHalf_s, kFewestOfHalf, kMostOfHalf), run_up = samples(kRunUp_s, 2 * kFewestOfHalf, kMostOfRunUp);
  out.step_s = step_s;
  out.noise_F_N = std::hypot(health.noise_F_N, health.lsb_F_N / std::sqrt(12.0));

  const std::vector<double> turn = turn_of(recorded_N);
  std::vector<std::size_t> order(t.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const double least = kAboveNoise * kOfNoise * out.noise_F_N * out.noise_F_N;
  std::erase_if(order, [&](std::size_t i) { return !(turn[i] > least) || i < run_up + half || i + half + 1 > t.size(); });
  std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t i) { return turn[i]; });
  const WholeStretches whole(t, recorded_N, U->value, bad, step_s);
  std::vector<std::size_t> middles;
  std::vector<std::uint8_t> is_taken(t.size(), 0);
  for (const std::size_t i : order) {
    if (middles.size() == kMostWindows) break;
    if (is_taken[i] != 0) continue;
    const std::size_t begin = i - std::min(i, 2 * half), end = std::min(t.size(), i + 2 * half + 1);
    std::fill(is_taken.begin() + static_cast<std::ptrdiff_t>(begin), is_taken.begin() + static_cast<std::ptrdiff_t>(end), std::uint8_t{1});
    if (whole.is_whole(i - half - run_up, i + half + 1) && is_resolved(recorded_N, i - half, i + half + 1, out.noise_F_N)) middles.push_back(i);
  }
  std::ranges::sort(middles);
  std::size_t next = 0;  // sample that is not kept yet
  for (const std::size_t i : middles) {
    for (std::size_t k = std::max(next, i - half - run_up); k < i + half + 1; ++k) {
      out.sample.push_back(static_cast<std::uint32_t>(k));
      out.t_s.push_back(t[k] - t.front());
      out.F_N.push_back(recorded_N[k]);
      out.U_V.push_back(U->value[k]);
    }
    next = i + half + 1;
    out.windows.push_back({out.t_s.size() - (2 * half + 1), out.t_s.size()});
  }
  return out;
}

}  // namespace forcegate::diagnose
