#pragma once
// What a record showed of its rig (hil/rig/rig_witness.h), for the checks that blame (hil/rig/self_check.h). NaN: cannot be told.

#include <cstdint>
#include <limits>

namespace forcegate {

struct RigObservation {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  // Time.
  std::uint64_t samples = 0;
  double first_t_s = 0.0, last_t_s = 0.0;
  std::uint64_t time_not_monotone = 0;  ///< steps <= 0 or not finite
  std::uint64_t time_gaps = 0;          ///< steps longer than 1.5 periods
  double worst_step_s = 0.0;            ///< largest |step - 1 / rate|
  double worst_gap_s = 0.0;             ///< largest step of time beyond one period

  // Codes of the converter, and rows with each status bit.
  std::uint16_t adc_min = 0xFFFF, adc_max = 0;
  std::uint16_t adc_bits_stuck = 0;  ///< bits below the range actually spanned that never changed
  std::uint64_t lost = 0;            ///< kRigSampleLost
  std::uint64_t reference_saturated = 0, reference_fault = 0;
  std::uint64_t motor_fault = 0, travel_stop = 0, adc_rail = 0;

  // The ATI.
  std::uint64_t reference_not_finite = 0;
  double reference_min_N = 0.0, reference_max_N = 0.0, reference_mean_N = 0.0;
  double reference_noise_N = 0.0;
  double zero_start_N = kUnknown, zero_end_N = kUnknown;  ///< unloaded, before and after the record

  // From one row to the next.
  /// Longest time without a change of the ATI's reading while the spring moved by 0.1 N; without a wheel the sensor's
  /// code is the witness (2 % of the range within 2 s), and the ATI that of the code.
  double reference_frozen_s = 0.0;
  double reference_stale_s = 0.0;  ///< all such times
  /// Longest time with one code between the rails while the spring moved, or code 0 under load.
  double sensor_dead_s = 0.0;
  double sensor_stale_s = 0.0;     ///< all times with one code between the rails while the spring moved
  double sensor_clipped_s = 0.0;   ///< of these, at the largest code of the record, which is not the converter's last
  std::uint64_t sensor_jumps = 0;  ///< steps of 2 % of the range from one code to the next while the ATI stood

  // Spring witness, NaN when the rig has no wheel.
  std::uint64_t spring_samples = 0;   ///< means over ten rows
  double spring_bias_N = 0.0;         ///< mean ATI - spring
  double spring_worst_bias_N = 0.0;   ///< signed mean over the worst block of 10 s
  double spring_slope = 1.0;          ///< d ATI / d spring by least squares; 1 when the force hardly moves
  double spring_rms_N = 0.0;          ///< about the mean
  double reference_lag_s = kUnknown;  ///< ATI behind the spring force
  double sensor_lag_s = kUnknown;     ///< sensor's code behind the ATI

  // The sensor against the ATI.
  std::uint64_t sensor_blocks = 0;      ///< blocks of 10 s in which the ATI moved and the converter had room
  std::uint64_t sensor_blocks_odd = 0;  ///< of these, in which the code did not follow the ATI: r^2 < 0.3

  // The drive against its command.
  double following_rad = kUnknown;             ///< rms of the following residual
  double command_step_rad = 0.0;               ///< rms step of the command from one control period to the next, times that period
  double theta_still_while_commanded_s = 0.0;  ///< longest time a commanded wheel stood still inside its travel
};

}  // namespace forcegate
