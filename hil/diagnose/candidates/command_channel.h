#pragma once
// S6: the force against what was commanded, for the motor alone.

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// What the drive makes of a command; sets has_command. After build_rig_channel.
void build_command_channel(Workspace& workspace, unsigned threads);

}  // namespace forcegate::diagnose
