#pragma once

#include <filesystem>
#include <string>

#include "hil/base/result.h"

namespace forcegate {

/// File for a plan's name: the path itself, ci/plans/NAME.toml in the current folder or beside the program.
Result<std::filesystem::path> find_plan(const std::string& name);

}  // namespace forcegate
