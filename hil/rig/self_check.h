#pragma once
// From what was observed of the rig to checks that blame the right party. Nothing here knows the firmware.
// A failed check has verdict rig_error: it takes the record out of the judgement, it never rejects a build.

#include <string>
#include <vector>

#include "hil/interface/check.h"
#include "hil/interface/rig.h"
#include "hil/rig/rig_witness.h"

namespace forcegate {

/// Tolerances of the self-check. Defaults hold for the Nano17 on the eccentric bench; "ours".
struct SelfCheckLimits {
  double spring_bias_N = 0.15;         ///< mean ATI - spring over any 10 s: 6 resolutions
  double spring_slope = 0.08;          ///< |slope - 1|
  double noise_factor = 3.0;           ///< times the declared noise and quantisation
  double reference_bad_share = 0.001;  ///< of the samples saturated, faulty or not finite
  double lost_share = 0.001;
  double frozen_s = 0.5;       ///< ATI reading unchanged while the wheel moves
  double wheel_still_s = 1.0;  ///< wheel unmoved while commanded
  double sensor_dead_s = 0.5;  ///< one code while the wheel moves, or code 0 under load
};

/// Ids: rig_reference_valid, rig_reference_noise, rig_reference_alive, rig_spring_witness, rig_spring_slope,
/// rig_motor, rig_sensor, rig_samples, rig_adc. Those a rig cannot have (no wheel in a recording) are left
/// out.
std::vector<Check> self_check(const RigInfo& info, const RigObservation& seen,
                              const SelfCheckLimits& limits = {});

/// The first check that is not a pass, nullptr when the rig is sound.
const Check* first_unsound(const std::vector<Check>& checks);

}  // namespace forcegate
