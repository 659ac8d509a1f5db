#pragma once
// The rig of a verb: its options, and what they choose.

#include <map>
#include <string>
#include <vector>

#include "hil/cli/command.h"

namespace forcegate {

/// Values NAME=VALUE of a repeatable option; the last of a name wins. Errors: usage.
Result<std::map<std::string, std::string>> named_values(const Invocation& in, const std::string& option);

/// --rig NAME|FILE, --rig-option NAME=VALUE, --arm.
std::vector<Option> rig_rows();

/// The same options as they were given, for the next command; "" where none was.
std::string rig_words(const Invocation& in);

struct RigChoice {
  std::string rig;
  std::map<std::string, std::string> options;
};
/// A bench file is the rig "bench" with that file; it is told the day (calibrations expire) and the command
/// line (shown to whoever else asks for the bench). A verb with --record plays recordings when that is given
/// and --rig is not. Errors: usage, also --arm on a rig where nothing moves.
Result<RigChoice> rig_choice(const Invocation& in);

/// --map COLUMN=NAME of the verbs that judge recordings, and its words one a line. Errors: usage.
Option map_row();
Result<std::string> column_map_lines(const Invocation& in);
/// --record and --map of the rig "replay". Errors: usage.
Result<void> take_recording(const Invocation& in, RigChoice& choice);

}  // namespace forcegate
