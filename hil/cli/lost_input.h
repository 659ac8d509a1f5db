#pragma once
// No verb may destroy what it reads: an output that is an input of the same command line is refused before the verb runs.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hil/cli/command.h"

namespace forcegate {

/// `values`: option or positional -> value, as the parser read them. What a value names stands in the row (Names). Refused are an output
/// file that is an input, campaign.json, result.json or a recording within an input folder; a folder of recordings that holds the input;
/// an existing file of the bundle of a run; an existing recording, by a verb without --force; two outputs in one file; and "-", which is no file. Devices and pipes are neither. The error (usage) names the file and the option to change.
std::optional<Error> lost_input(const Command& command, const std::vector<std::pair<std::string, std::string>>& values);

}  // namespace forcegate
