#pragma once

#include <filesystem>
#include <string>

#include "hil/base/result.h"

namespace forcegate {

/// All bytes of a file. Errors (io, with the path): it does not exist, is a folder, cannot be read.
Result<std::string> read_file(const std::filesystem::path& path);

}  // namespace forcegate
