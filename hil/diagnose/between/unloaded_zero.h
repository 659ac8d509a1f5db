#pragma once
// Whose zero moves, told by records, or stretches of one, that come down to no load. A press cannot pull: there the output is that of no force, and what the reference
// shows instead is an error of its own zero. A zero of the sensor moves the output there and leaves the reference alone.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "hil/diagnose/base/mixed_model.h"
#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

struct UnloadedZero {
  std::size_t records = 0;  ///< that come down to one load, the lowest; of one recording: stretches
  std::size_t of = 0;       ///< all of them
  double spread_N = 0.0;    ///< standard deviation of the zero of the reference over them
  std::vector<double> at;   ///< number of the record in the campaign, from 1; of one recording: in the middle of the stretch, s
  std::vector<double> shown_N, left_N;  ///< what the reference shows at the lowest load, and that less its own zero; each less its mean
};

/// `fit`: gain and zero of every record beside all effects. With F at the lowest fiftieth of a record's rows and its zero e (both N), F + e is
/// the load there as the output tells it. Found where four records and half of all come down to the lowest load, F + e scatters over them by less
/// than three tenths of what e does (a tenth where every F is more than twice what e scatters by), the output itself by less than half of it, and e
/// by 0.5 % of the range and three steps of the reference and more, without any one record too. A single recording is taken in a dozen stretches, each with
/// a zero of its own beside one gain. Nothing where angle (by one zero for all records), command or capacitance tell of the force themselves.
std::optional<UnloadedZero> unloaded_zero_of_reference(const Workspace& workspace, const MixedFit& fit);

/// Effects of the sensor among the chosen, between the records or of one recording, that take part of such zeros for theirs: what moves without
/// load is the reference, whatever fits. Empty where the zeros tell nothing, or are no smaller beside what was chosen.
std::vector<std::string> contradicted_without_load(const Workspace& workspace, const Selection& selection);

}  // namespace forcegate::diagnose
