#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "hil/base/result.h"

namespace forcegate {

/// Writes to a temporary file beside `path`, syncs and renames it: a reader sees the old file, or the whole new one,
/// never half of one. A symbolic link stays, and what it leads to is replaced. Makes missing parent folders. Errors: io; usage
/// where a link leads nowhere.
Result<void> write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// The folder with those above it. Errors: io, with the folder that cannot be made; usage where a link leads nowhere.
Result<void> make_folder(const std::filesystem::path& folder);

/// Those of the folder and of the folders above it that make_folder() would make, the innermost first; a link that leads nowhere is none.
std::vector<std::filesystem::path> missing_folders(const std::filesystem::path& folder);

/// Asked before long work: whether a file can be written there as things stand. Makes nothing that stays. Errors: as of the write.
Result<void> check_writable(const std::filesystem::path& path);

}  // namespace forcegate
