#pragma once

#include <filesystem>

#include "hil/base/result.h"

namespace forcegate {

/// Where an output goes that is renamed into place: the path itself, or what its symbolic link leads to, so that the link stays.
/// Errors (usage): a link that leads nowhere, or in a circle.
Result<std::filesystem::path> output_path(const std::filesystem::path& path);

}  // namespace forcegate
