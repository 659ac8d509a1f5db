#pragma once
// What follows a limits file that was just written, as a command that works when it is pasted.

#include <string>

#include "hil/app/power/limits.h"
#include "hil/cli/command.h"

namespace forcegate {

/// A plan that takes derived limits: what blessing them would change. Any other: the known-good build under them, on the rig or the
/// recordings that `on` names (" --rig bench.toml", "" = the emulated rig).
std::string line_after_limits(const Invocation& in, const DerivedLimits& limits, const std::string& file, const std::string& on);

/// "forcegate bless SOURCE --reason ... --who ..."; `who` and `reason` as the shell shall read them.
std::string bless_line(const std::string& source, const std::string& reason, const std::string& who);

}  // namespace forcegate
