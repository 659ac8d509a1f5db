#pragma once
// Faults of the bench by name. Each changes one thing from an instant on, or all the time. Those that happen in mid-run
// without naming an instant begin when a third of the record is over.

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "hil/base/result.h"

namespace forcegate::emulated {

inline constexpr double kNever_s = std::numeric_limits<double>::infinity();

/// Values that switch nothing on.
struct Faults {
  // Reference
  double reference_saturated_N =
      std::numeric_limits<double>::infinity();  ///< the cell overloads at this force
  double reference_offset_N = 0.0;
  double reference_drift_N_per_min = 0.0;
  double reference_gain = 1.0;
  bool reference_foreign_calibration = false;  ///< reports another calibration than the bench names
  double reference_axis_share = 1.0;           ///< share of the force that the axis read out sees
  double reference_frozen_s = kNever_s;        ///< from here on the reading repeats
  double reference_late_s = 0.0;
  double reference_stale = 0.0;  ///< share of the 100-ms stretches in which the reading repeats
  // Motor, wheel and spring
  double motor_stalled_s = kNever_s;
  double motor_ripple_rad = 0.0;    ///< amplitude, twelve times a turn
  double motor_backlash_rad = 0.0;  ///< play between shaft (read back) and wheel
  double preload_wrong_mm = 0.0;    ///< from the start
  double spring_slipped_mm = 0.0;   ///< lost in mid-run
  double spring_stiffness = 1.0;    ///< factor on the spring's constant
  double head_motion = 0.0;         ///< scale of a patient's motion (head.h)
  // Sensor and converter
  double sensor_unplugged_s = kNever_s;  ///< input pulled to 0 V
  double sensor_gain = 1.0;              ///< another specimen than the calibrated one: factor on its signal
  double sensor_late_s = 0.0;
  double sensor_stale = 0.0;  ///< share of the 100-ms stretches in which the code repeats
  int adc_stuck_bit = -1;     ///< this bit reads 1
  // Link and clock
  double sample_loss = 0.0;       ///< share of samples that never arrive
  double clock_skew = 0.0;        ///< relative error of the time stamps
  double clock_jump_s = 0.0;      ///< in mid-run
  double truncated_s = kNever_s;  ///< the record ends here

  bool operator==(const Faults&) const = default;
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

/// Error (config) for an unknown name, with a suggestion, or a magnitude out of range or that
/// changes nothing.
Result<Faults> parse_faults(const std::map<std::string, double>& by_name);

}  // namespace forcegate::emulated
