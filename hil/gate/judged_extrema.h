#pragma once
// The extrema of a record that count: those after ramp-in and start window.

#include <limits>
#include <utility>
#include <vector>

#include "hil/base/quantile.h"
#include "hil/gate/runner.h"
#include "hil/gate/statistics.h"

namespace forcegate {

inline constexpr double kExtremumFloor_N = 0.1;  ///< below, a relative error says nothing

/// Open loop: firmware against ATI. Closed loop: ATI against set-point. N.
struct JudgedExtrema {
  std::vector<double> actual, expected;
};

inline JudgedExtrema judged_extrema(const PlanCase& planned, const CaseRecord& record, bool maximum) {
  JudgedExtrema e;
  const bool closed = planned.loop == LoopMode::closed;
  const double from_s = judged_from_s(planned, record);
  for (const CasePair& p : record.pairs) {
    if (p.maximum != maximum || p.t_s < from_s) continue;
    e.expected.push_back(closed ? p.setpoint_N : p.ati_N);
    e.actual.push_back(closed ? p.ati_N : p.dut_N);
  }
  return e;
}

/// Force of the minima, which below PlanLimits::minima_floor_N have no relative error. A recording's own force channel begins
/// with the loading: its bounds say nothing about the settled minima, whose mean it is; NaN where none was recorded.
inline double minima_N(const PlanCase& planned, const CaseRecord& record) {
  return record.rig.can_move ? record.facts.mean_N - record.facts.amplitude_N : moments(judged_extrema(planned, record, false).expected).mean;
}

/// Of the swing that most extrema from `from_s` on belong to, s; infinity with fewer than four swings.
inline double shortest_period_s(const std::vector<CasePair>& pairs, double from_s) {
  std::vector<double> half_s;
  for (std::size_t i = 1; i < pairs.size(); ++i)
    if (pairs[i - 1].t_s >= from_s && pairs[i].maximum != pairs[i - 1].maximum) half_s.push_back(pairs[i].t_s - pairs[i - 1].t_s);
  if (half_s.size() < 4) return std::numeric_limits<double>::infinity();
  return 2.0 * median(std::move(half_s));
}

}  // namespace forcegate
