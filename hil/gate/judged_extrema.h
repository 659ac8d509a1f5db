#pragma once
// The extrema of a record that count: those after ramp-in and start window.

#include <vector>

#include "hil/gate/runner.h"

namespace forcegate {

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

}  // namespace forcegate
