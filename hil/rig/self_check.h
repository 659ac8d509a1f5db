#pragma once
// From what was observed of the rig to checks that blame the right party. Nothing here knows the firmware.
// A failed check has verdict rig_error: it takes the record out of the judgement, it never rejects a build.

#include <string>
#include <vector>

#include "hil/interface/check.h"
#include "hil/interface/rig.h"
#include "hil/rig/rig_observation.h"

namespace forcegate {

/// Tolerances of the self-check. Defaults hold for the Nano17 on the eccentric bench; "ours".
struct SelfCheckLimits {
  double zero_N = 0.03;                ///< unloaded ATI, before and after: its resolution and a little noise
  double spring_bias_N = 0.06;         ///< mean ATI - spring over any 10 s
  double spring_slope = 0.02;          ///< |slope - 1|
  double spring_scatter_N = 0.05;      ///< standard deviation of ATI - spring: play between shaft and wheel
  double following_rad = 0.02;         ///< rms of theta beyond the drive's own first-order lag
  double reference_lag_s = 0.005;      ///< |ATI behind spring|; play that gives more tips the extrema of a small fast line
  double noise_factor = 3.0;           ///< times the declared noise and quantisation
  double reference_bad_share = 0.001;  ///< of the samples saturated, faulty or not finite
  double lost_share = 0.001;
  double stale_share = 0.001;     ///< of the time with an unchanged reading while the spring moves
  double frozen_s = 0.5;          ///< ATI reading unchanged while the wheel moves
  double wheel_still_s = 1.0;     ///< wheel unmoved while commanded
  double sensor_dead_s = 0.5;     ///< one code while the wheel moves, or code 0 under load
  double sensor_odd_share = 0.1;  ///< of the 10-s blocks in which the code does not follow the ATI
  double jump_share = 2e-5;       ///< of the samples at which the sensor's code jumps and the ATI does not
  double gap_s = 0.1;             ///< one step of time beyond the period
  double clock_rel = 1e-3;        ///< |time stamps over samples - 1|
};

/// Of RigInfo::details, a number: share of the harness's ticks that came later than a reading of the reference counts. Readings
/// that are missing in no more than that share of the rows are not the reference's: nobody asked for them in time.
inline constexpr const char* kLateTickShare = "share of ticks later than a reading counts";
/// The same of the time of the record: one call of a second holds up a hundred ticks' worth of readings.
inline constexpr const char* kLateTimeShare = "share of the time later than a reading counts";
/// Of RigInfo::details: what held the harness up longest, where that is longer than a reading of the reference counts.
inline constexpr const char* kSlowestCall = "slowest call";
inline constexpr const char* kCallOfReference = "polling the ATI";  ///< one that is slow itself is not excused by it

/// Ids: rig_samples, rig_clock, rig_reference_identity, rig_reference_zero, rig_reference_valid, rig_reference_noise,
/// rig_reference_alive, rig_motor, rig_following, rig_reference_lag, rig_spring_witness, rig_spring_slope,
/// rig_spring_scatter, rig_adc, rig_sensor, rig_sensor_jumps, rig_sensor_follows. Those a rig cannot have (no wheel in a recording, no
/// unloaded reading) are left out. Who is blamed for a disagreement of ATI and spring: the reference when its own unloaded
/// reading is off, its calibration is another than the bench's or no spring could be that soft or stiff; the rig when
/// the unloaded readings are sound; without them the reference for what is steady, the rig for what changes.
std::vector<Check> self_check(const RigInfo& info, const RigObservation& seen,
                              const SelfCheckLimits& limits = {});

/// The first check that is not a pass, nullptr when the rig is sound.
const Check* first_unsound(const std::vector<Check>& checks);

}  // namespace forcegate
