#pragma once
// Watches the rig, not the firmware, while a record streams past. What it sees decides whether the record may
// be used to judge a build at all (hil/rig/self_check.h).
//
// Spring witness: the ATI force against F = k (preload + e (1 - cos theta)), theta read back from the drive.
// Following: theta against the integral of the commanded velocity. A sound drive of first order lags by tau v, so what
// is judged is the residual of (integral of command - theta) = tau v + const over stretches inside the travel. When a
// command takes effect is known to one control period only: a command that steps by dv may show T dv of that as residual.
// Sensor: within 10 s the film's loss hardly changes, so its code must follow the ATI in a straight line.
// Noise: standard deviation from second differences, sqrt(mean (x[i-1] - 2 x[i] + x[i+1])^2 / 6); the motion
// of the profile drops out, the noise of a sound reference and its quantisation remain.

#include <array>
#include <cstdint>
#include <limits>

#include "hil/interface/rig.h"
#include "hil/trace/lag_fit.h"

namespace forcegate {

struct RigObservation {
  std::uint64_t samples = 0;
  double first_t_s = 0.0, last_t_s = 0.0;
  std::uint64_t time_not_monotone = 0;  ///< steps <= 0 or not finite
  std::uint64_t time_gaps = 0;          ///< steps longer than 1.5 periods
  double worst_step_s = 0.0;            ///< largest |step - 1 / rate|
  std::uint64_t lost = 0;               ///< kRigSampleLost
  std::uint64_t reference_saturated = 0, reference_fault = 0, reference_not_finite = 0;
  std::uint64_t motor_fault = 0, travel_stop = 0, adc_rail = 0;
  double reference_min_N = 0.0, reference_max_N = 0.0, reference_mean_N = 0.0;
  double reference_noise_N = 0.0;
  double reference_frozen_s =
      0.0;  ///< longest time without a change of the reading while the spring moved by 0.1 N; without a wheel the sensor's
            ///< code is the witness (2 % of the range within 2 s), and the ATI that of the code
  double sensor_dead_s =
      0.0;  ///< longest time with one code between the rails while the spring moved, or code 0 under load
  double theta_still_while_commanded_s =
      0.0;  ///< longest time a commanded wheel stood still inside its travel
  std::uint16_t adc_min = 0xFFFF, adc_max = 0;
  std::uint16_t adc_bits_stuck = 0;  ///< bits below the range actually spanned that never changed
  // Spring witness, NaN when the rig has no wheel.
  std::uint64_t spring_samples = 0;
  double spring_bias_N = 0.0;        ///< mean ATI - spring
  double spring_worst_bias_N = 0.0;  ///< signed mean over the worst block of RigWitness::kBlockSeconds
  double spring_slope = 1.0;         ///< d ATI / d spring by least squares; 1 when the force hardly moves
  double spring_rms_N = 0.0;         ///< about the mean
  double reference_lag_s = std::numeric_limits<double>::quiet_NaN();  ///< ATI behind the spring force
  double sensor_lag_s = std::numeric_limits<double>::quiet_NaN();     ///< sensor's code behind the ATI
  double following_rad = std::numeric_limits<double>::quiet_NaN();    ///< rms of the following residual
  double command_step_rad = 0.0;  ///< rms step of the command from one control period to the next, times that period
  double zero_start_N =
      std::numeric_limits<double>::quiet_NaN();  ///< unloaded ATI before the record; NaN: not taken
  double zero_end_N = std::numeric_limits<double>::quiet_NaN();  ///< and after it
  double reference_stale_s =
      0.0;                      ///< all times without a change of the reading while the spring moved by 0.1 N
  double sensor_stale_s = 0.0;  ///< the same of the sensor's code
  double sensor_clipped_s = 0.0;  ///< of these, at the largest code of the record, which is not the converter's last
  double worst_gap_s = 0.0;     ///< largest step of time beyond one period
  std::uint64_t sensor_jumps =
      0;  ///< steps of 2 % of the range from one code to the next while the ATI stood
  std::uint64_t sensor_blocks = 0;      ///< blocks of 10 s in which the ATI moved and the converter had room
  std::uint64_t sensor_blocks_odd = 0;  ///< of these, in which the code did not follow the ATI: r^2 < 0.3
};

class RigWitness {
 public:
  static constexpr double kBlockSeconds = 10.0;  ///< of spring_worst_bias_N
  static constexpr std::uint64_t kLeastSpringSamples = 10;  ///< fewer tell nothing of the spring
  static constexpr double kCommandPeriod_s = 0.01;          ///< commands come at this distance

  void begin(const RigInfo& info);
  /// Rows [0, n) of the block; commanded is the velocity the rig was told for each of them (may be null).
  void push(const RigBlock& block, std::size_t n, const float* commanded_rad_per_s = nullptr);
  /// Unloaded readings, when the rig can take them.
  void zero_before(const ReferenceZero& zero) {
    if (zero.n > 0) o_.zero_start_N = zero.mean_N;
  }
  void zero_after(const ReferenceZero& zero) {
    if (zero.n > 0) o_.zero_end_N = zero.mean_N;
  }
  RigObservation finish() const;

 private:
  double spring_N(double theta_rad) const;
  void push_time(const RigBlock& block, std::size_t n);
  void push_codes(const RigBlock& block, std::size_t n);
  void count_strange_times(const RigBlock& block, std::size_t n);
  // kSound: no row of the block has a status bit or a value that is not finite, so nobody need ask.
  template <bool kSound>
  void push_rows(const RigBlock& block, std::size_t n, const float* commanded_rad_per_s);
  template <bool kSound>
  void push_force(const RigBlock& block, std::size_t n);
  template <bool kSound>
  void push_changes(const RigBlock& block, std::size_t n);
  template <bool kSound>
  void push_groups(const RigBlock& block, std::size_t n);
  template <bool kSound>
  void push_wheel(const RigBlock& block, std::size_t n, const float* commanded_rad_per_s);
  void push_spring(double t_s, double theta_rad, double force_N, double code);
  void close_block();

  RigInfo info_;
  RigObservation o_;
  double period_s_ = 1e-3;
  double previous_t_s_ = 0.0;
  float x1_ = 0.0f, x2_ = 0.0f;
  int valid_run_ = 0;
  double sum_second_ = 0.0, sum_force_ = 0.0;
  std::uint64_t second_n_ = 0, force_n_ = 0;
  /// How long a reading has not changed, and whether its witness has moved meanwhile.
  struct Still {
    std::uint64_t run = 0;
    float witness = 0.0f;
    bool moved = false;
  };
  enum class Witness { wheel_rad, force_N, code };
  bool moves(Witness witness, float from, float to) const;
  void examine(Still& still, Witness witness, float now, double& longest_s) const;
  Still reference_still_, sensor_still_;
  std::uint16_t previous_code_ = 0, clip_code_ = 0;
  double clip_s_ = 0.0;
  std::uint64_t theta_run_ = 0, dead_run_ = 0;
  float previous_theta_ = 0.0f, previous_force_N_ = std::numeric_limits<float>::quiet_NaN();
  std::uint16_t adc_or_ = 0, adc_and_ = 0xFFFF;
  // Means over ten samples.
  int group_n_ = 0;
  double group_theta_ = 0, group_force_ = 0, group_code_ = 0;
  double sx_ = 0, sy_ = 0, sxx_ = 0, sxy_ = 0, syy_ = 0;
  LagFit reference_lag_, sensor_lag_;
  // Block of kBlockSeconds.
  struct Block {
    double start_s = 0, n = 0, bias = 0, f = 0, c = 0, ff = 0, fc = 0, cc = 0, code_low = 1e9,
           code_high = -1e9;
  };
  Block block_;
  // Following: e = integral of command - theta, v = theta', both through the same high pass.
  double follow_e_ = 0, follow_v_ = 0, follow_previous_v_ = 0;
  float follow_last_ = std::numeric_limits<float>::quiet_NaN();
  double fn_ = 0, fee_ = 0, fev_ = 0, fvv_ = 0;
  float previous_command_ = 0.0f;
  double command_steps_ = 0, command_rows_ = 0;
};

}  // namespace forcegate
