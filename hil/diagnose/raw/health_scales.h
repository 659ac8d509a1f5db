#pragma once
// What the samples of all records of a campaign are judged by.

#include <string>

#include "hil/trace/campaign.h"

namespace forcegate::diagnose {

struct HealthScales {
  double gain_V_per_N = 2.0;
  double range_N = 5.0, U_range_V = 10.0;
  double step_N = 0.0, step_V = 0.0;  ///< of the values of all records together; 0: none is visible
  std::string unit = "V";             ///< of the output
  bool thrown = false;                ///< excursions of a few samples stand up and down by sizes that differ, in a record
                                      ///< or in all together (short_spikes.h)
};

/// Coarse static gain and spans over all records (least squares of U on F), and what their samples do together.
HealthScales health_scales(const Campaign& campaign, unsigned threads = 1);

}  // namespace forcegate::diagnose
