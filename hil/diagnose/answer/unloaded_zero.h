#pragma once
// Whose zero moves, told by records that come down to no load. A press cannot pull: there the output is that of no force, and what the reference
// shows instead is an error of its own zero. A zero of the sensor moves the output there and leaves the reference alone.

#include <cstddef>
#include <optional>

#include "hil/diagnose/base/mixed_model.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Form of such a finding.
inline constexpr const char* kUnloadedZero = "unloaded";

struct UnloadedZero {
  std::size_t records = 0;  ///< that come down to one load, the lowest
  double spread_N = 0.0;    ///< standard deviation of the zero of the reference over them
};

/// `fit`: gain and zero of every record beside all effects. With F at the lowest fiftieth of a record's rows and its zero e (both N), F + e is
/// the load there as the output tells it. Found where four records and half of all come down to the lowest load, F + e scatters over them by less
/// than three tenths of what e does, and e by 0.5 % of the range and three steps of the reference and more. Nothing for a single recording, and
/// where angle, command or capacitance tell of the force themselves.
std::optional<UnloadedZero> unloaded_zero_of_reference(const Workspace& workspace, const MixedFit& fit);

/// Claims reference_drift by it, where nothing else does and no claim explains the zeros.
void claim_unloaded_zero(const Workspace& workspace, const MixedFit& fit, Diagnosis& out);

}  // namespace forcegate::diagnose
