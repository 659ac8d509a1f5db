#include "hil/diagnose/answer/load_direction.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "hil/base/quantile.h"
#include "hil/diagnose/answer/force_turns.h"

namespace forcegate::diagnose {

namespace {

double prominence_of(const RecordInput& r, double range_N) {
  constexpr double kLeast = 0.01, kMost = 0.04, kPeakToPeak = 6.0;  // of the range; of the standard deviation
  std::vector<double> bend;
  for (std::size_t i = 2; i < r.rows(); ++i) bend.push_back(std::abs(r.F_N[i] - 2.0 * r.F_N[i - 1] + r.F_N[i - 2]));
  if (bend.empty()) return kLeast * range_N;
  const double sigma = median(std::move(bend)) / (0.6745 * std::sqrt(6.0));
  return std::clamp(kPeakToPeak * sigma, kLeast * range_N, kMost * range_N);
}

// From a turning point on the other way, from the row of the turn itself.
std::vector<double> between_turns(const RecordInput& r, double prominence) {
  std::vector<double> out;
  double sign = 0.0;
  for (const ForceTurn& turn : force_turns(r.F_N, prominence)) {
    out.resize(turn.row, sign);
    sign = turn.is_highest ? -1.0 : 1.0;
  }
  out.resize(r.rows(), sign);
  return out;
}

// Rows before (after) which the force stays within `prominence` for the whole of `window_s`.
std::vector<bool> stays(const RecordInput& r, double prominence, double window_s, bool before) {
  const std::size_t n = r.rows();
  std::vector<bool> out(n, false);
  const auto row = [&](std::size_t i) { return before ? i : n - 1 - i; };
  std::deque<std::size_t> highest, lowest;
  std::size_t from = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double F = r.F_N[row(i)], t = r.t_s[row(i)];
    while (!highest.empty() && r.F_N[row(highest.back())] <= F) highest.pop_back();
    while (!lowest.empty() && r.F_N[row(lowest.back())] >= F) lowest.pop_back();
    highest.push_back(i), lowest.push_back(i);
    while (std::abs(t - r.t_s[row(from)]) > window_s) ++from;
    while (highest.front() < from) highest.pop_front();
    while (lowest.front() < from) lowest.pop_front();
    out[row(i)] = from > 0 && r.F_N[row(highest.front())] - r.F_N[row(lowest.front())] < prominence;
  }
  return out;
}

}  // namespace

std::vector<double> load_direction(const RecordInput& r, double range_N) {
  constexpr double kWindow_s = 4.0;
  if (r.rows() == 0) return {};
  const double prominence = prominence_of(r, range_N);
  std::vector<double> out = between_turns(r, prominence);
  const std::vector<bool> before = stays(r, prominence, kWindow_s, true), after = stays(r, prominence, kWindow_s, false);
  for (std::size_t i = 0; i < out.size(); ++i)
    if (before[i] || after[i]) out[i] = 0.0;
  return out;
}

}  // namespace forcegate::diagnose
