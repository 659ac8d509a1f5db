#pragma once

#include <filesystem>
#include <string>

#include "hil/base/result.h"

namespace forcegate {

/// File for a plan's name: the path itself, ci/plans/NAME.toml in the current folder or beside the program.
/// Errors (usage): there is none, with the likeliest. What holds a slash or ends in .toml is a path and no name.
Result<std::filesystem::path> find_plan(const std::string& name);

}  // namespace forcegate
