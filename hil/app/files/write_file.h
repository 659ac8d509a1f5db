#pragma once

#include <filesystem>
#include <string_view>

#include "hil/base/result.h"

namespace forcegate {

/// Writes to a temporary file beside `path`, syncs and renames it: a reader sees the old file, or the whole new one,
/// never half of one. Makes missing parent folders. Errors: io.
Result<void> write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

}  // namespace forcegate
