#pragma once
// Under which conditions a run was played, beyond plan, seed and rig: what a stored run must share with the one that is held against it.

#include <filesystem>

#include "hil/app/gate/gate.h"
#include "hil/app/gate/gate_jobs.h"

namespace forcegate {

/// Faults and options of the rig into RunResult::environment, where there are any.
void state_conditions(const GateRequest& request, RunResult& head);

inline constexpr const char *kFaults = "faults", *kRigOptions = "rig options", *kNoCondition = "none";

/// kFaults or kRigOptions of a run; "none" where it states none.
std::string stated_condition(const RunResult& run, const std::string& what);

/// Errors (usage): `stored`, read from `path`, is of another plan, seed or rig than `head`, of other faults or options of the rig, or of
/// another calibration as far as it is known before anything is played. Of one that is measured, or that another day needed, that is its level. `setup` is
/// null under weights, which have neither.
Result<void> check_same_conditions(const RunResult& stored, const RunResult& head, const GateRequest& request, const GateSetup* setup,
                                   const std::filesystem::path& path);

/// What differs, in words; empty where both firmwares were told the same. The name of a calibration is none of its values.
std::string calibration_difference(const Calibration& a, const Calibration& b);

}  // namespace forcegate
