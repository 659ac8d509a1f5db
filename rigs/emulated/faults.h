#pragma once
// Faults of the bench by name. Each changes one thing from an instant on, or all the time.

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "hil/base/result.h"

namespace forcegate::emulated {

/// Values that switch nothing on.
struct Faults {
  double reference_saturated_N =
      std::numeric_limits<double>::infinity();  ///< the cell overloads at this force
  double reference_offset_N = 0.0;
  double reference_frozen_s = std::numeric_limits<double>::infinity();  ///< from here on the reading repeats
  double motor_stalled_s = std::numeric_limits<double>::infinity();
  double sensor_unplugged_s = std::numeric_limits<double>::infinity();  ///< input pulled to 0 V
  int adc_stuck_bit = -1;                                               ///< this bit reads 1
  double head_motion = 0.0;                                      ///< scale of a patient's motion (head.h)
  double sample_loss = 0.0;                                      ///< share of samples that never arrive
  double truncated_s = std::numeric_limits<double>::infinity();  ///< the record ends here

  /// Something has to be done to finished rows.
  bool touches_rows() const;
};

struct FaultKind {
  std::string name;
  std::string doc;  ///< what the magnitude means
  double minimum, maximum;
  void (*set)(Faults&, double magnitude);
};

const std::vector<FaultKind>& fault_kinds();

/// Error (config) for an unknown name, with a suggestion, or a magnitude out of range.
Result<Faults> parse_faults(const std::map<std::string, double>& by_name);

}  // namespace forcegate::emulated
