#pragma once

#include "hil/trace/campaign.h"

namespace forcegate {

/// A record that is cycled from 2 s on, at 0.5 Hz between 1.1 and 3.2 N.
inline void declare_cycled(Record& r) {
  r.dynamic = true;
  r.excitation_start_s = 2.0;
  r.f_min_Hz = 0.5;
  r.A_N = 1.05;
  r.m_N = 2.15;
}

}  // namespace forcegate
