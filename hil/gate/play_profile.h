#pragma once
// Plays one force profile on a rig in open loop, without a firmware: calibrations and recordings of a campaign. The rig
// is checked at the end (hil/rig/self_check.h), so that a record which comes back is sound and whole.

#include <atomic>
#include <cstdint>
#include <functional>

#include "hil/interface/rig.h"
#include "hil/interface/stimulus.h"
#include "hil/rig/rig_observation.h"
#include "hil/rig/safety_gate.h"

namespace forcegate {

struct PlayedProfile {
  RigInfo rig;
  RigObservation observed;
  SafetyReport safety;
  std::uint64_t samples = 0, expected_samples = 0;
};

/// Rows [0, rows) of a block, in order of time.
using ProfileSink = std::function<void(const RigBlock& block, std::size_t rows)>;

/// Rows [from, from + n) of a block, final; in time for a recording that survives `kill -9`.
using ProfileSaver = std::function<Result<void>(const RigBlock& block, std::size_t from, std::size_t n)>;

/// `request` says specimen, seed, session, record and rest; duration and force range are taken from the stimulus. `out` is
/// filled as far as the record went, also when it failed. Errors: what the rig said (its own code); device when the
/// self-check fails; safety after a stop; timeout when the record is truncated; cancelled; internal.
Result<void> play_profile(Rig& rig, const Stimulus& stimulus, RigRecordRequest request,
                          const SafetyLimits& safety, const ProfileSink& sink,
                          const std::atomic<bool>* cancelled, PlayedProfile& out,
                          const ProfileSaver& saver = {});

}  // namespace forcegate
