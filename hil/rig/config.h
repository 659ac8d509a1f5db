#pragma once
// TOML files (plans, benches, limits) as values with positions. The TOML library stays inside config.cpp.

#include <filesystem>
#include <string>
#include <string_view>

#include "hil/base/config_node.h"

namespace forcegate {

/// Error code config, with position. `name` is what errors call the file. At most 1 MB, nesting at most 16.
Result<ConfigNode> parse_config(std::string_view text, const std::string& name);
Result<ConfigNode> read_config(const std::filesystem::path& path);

}  // namespace forcegate
