#include "hil/rig/witness/time_watch.h"

#include <algorithm>
#include <cmath>

namespace forcegate::witness {
namespace {
constexpr double kGap = 1.5;  // periods
}  // namespace

void TimeWatch::push(const double* t_s, std::size_t n) {
  if (samples_ == 0) {
    first_t_s_ = t_s[0];
    previous_t_s_ = t_s[0] - period_s_;
  }
  // The smallest and the largest step say it all unless there is a gap or a step back.
  constexpr std::size_t kLanes = 4;
  const double first_s = t_s[0] - previous_t_s_;
  double low_s[kLanes], high_s[kLanes];
  std::fill_n(low_s, kLanes, first_s);
  std::fill_n(high_s, kLanes, first_s);
  unsigned back = !(first_s > 0.0);
  std::size_t i = 1;
  for (; i + kLanes <= n; i += kLanes)
    for (std::size_t k = 0; k < kLanes; ++k) {
      const double step_s = t_s[i + k] - t_s[i + k - 1];
      back |= !(step_s > 0.0);
      low_s[k] = step_s < low_s[k] ? step_s : low_s[k];
      high_s[k] = step_s > high_s[k] ? step_s : high_s[k];
    }
  for (; i < n; ++i) {
    const double step_s = t_s[i] - t_s[i - 1];
    back |= !(step_s > 0.0);
    low_s[0] = std::min(low_s[0], step_s);
    high_s[0] = std::max(high_s[0], step_s);
  }
  const double shortest_s = *std::min_element(low_s, low_s + kLanes),
               longest_s = *std::max_element(high_s, high_s + kLanes);
  if (back != 0 || longest_s > kGap * period_s_) {
    count_strange(t_s, n);
  } else {
    worst_step_s_ = std::max({worst_step_s_, std::fabs(shortest_s - period_s_), std::fabs(longest_s - period_s_)});
    worst_gap_s_ = std::max(worst_gap_s_, longest_s - period_s_);
  }
  previous_t_s_ = t_s[n - 1];
  samples_ += n;
}

void TimeWatch::count_strange(const double* t_s, std::size_t n) {
  double previous_s = previous_t_s_;
  for (std::size_t i = 0; i < n; ++i) {
    const double step_s = t_s[i] - previous_s;
    previous_s = t_s[i];
    not_monotone_ += !(step_s > 0.0);
    gaps_ += step_s > kGap * period_s_;
    worst_step_s_ = std::max(worst_step_s_, std::fabs(step_s - period_s_));
    worst_gap_s_ = std::max(worst_gap_s_, step_s - period_s_);
  }
}

void TimeWatch::finish(RigObservation& o) const {
  o.samples = samples_;
  o.first_t_s = first_t_s_;
  o.last_t_s = previous_t_s_;
  o.time_not_monotone = not_monotone_;
  o.time_gaps = gaps_;
  o.worst_step_s = worst_step_s_;
  o.worst_gap_s = worst_gap_s_;
}

}  // namespace forcegate::witness
