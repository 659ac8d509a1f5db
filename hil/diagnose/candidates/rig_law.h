#pragma once
// S6: F_ref against what the rig makes of its angle or command.

#include <vector>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Share of the force span below which a contact counts as open: the force stands at zero whatever the rig does.
inline constexpr double kOpenContact = 0.02;

/// Candidates and Gram matrices of F_ref against angle or command; sets has_rig.
void build_rig_channel(Workspace& workspace, unsigned threads);

/// Fills rig_force_N of the records with a witness and lists them: by the declared geometry and one stiffness for all
/// where it is known (then the zero of the reference shows), else by each record's own line.
void find_rig_law(Workspace& workspace, std::vector<std::size_t>& records, unsigned threads);

}  // namespace forcegate::diagnose
