#pragma once

#include <filesystem>
#include <string>

#include "hil/base/result.h"

namespace forcegate {

/// True for a pipe ("/dev/stdin", "<(command)"), whose bytes come once.
bool is_pipe(const std::filesystem::path& path);

/// All bytes of a file. Those of a pipe are kept, and given again to who asks for it again. Errors (io, with the path): it does not exist, is
/// a folder, cannot be read.
Result<std::string> read_file(const std::filesystem::path& path);

}  // namespace forcegate
