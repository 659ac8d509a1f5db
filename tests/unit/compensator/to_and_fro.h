#pragma once

#include <cmath>

#include "hil/trace/campaign.h"

namespace forcegate {

/// Twenty seconds of a static sine of 0.5 to 3.5 N at 0.5 N/V, 200 Hz.
inline Record record() {
  Record r;
  r.name = "to and fro";
  r.dynamic = false;
  TimeBase clock;
  Channel F{"F_ref", "N", "force", 0, {}, {}}, U{"U", "V", "voltage", 0, {}, {}};
  for (int i = 0; i < 4000; ++i) {
    const double t = i / 200.0;
    clock.t_s.push_back(t);
    F.value.push_back(2.0 + 1.5 * std::sin(1.3 * t));
    U.value.push_back(F.value.back() / 0.5);
  }
  r.trace.time_bases = {clock};
  r.trace.channels = {F, U};
  return r;
}

}  // namespace forcegate
