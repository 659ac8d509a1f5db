#pragma once
// Files that come with the program, by paths that can be pasted from where the user stands.

#include <filesystem>
#include <optional>
#include <string>

namespace forcegate {

/// Folder of the running program; empty when the system does not tell.
std::filesystem::path program_folder();

/// "rigs/twin.toml" where the file lies below the current folder, else its absolute path.
std::string path_from_here(const std::filesystem::path& path);

/// A firmware image that was built with the program ("reference.native.so"); nullopt: it is not there.
std::optional<std::string> shipped_image(const std::string& name);

}  // namespace forcegate
