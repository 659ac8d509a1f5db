#pragma once
// The socket by which twins in a folder are commanded. Who answers there serves them.

#include <sys/un.h>

#include <filesystem>

#include "hil/base/result.h"

namespace forcegate::emulated {

/// Errors: config, where the name is too long for a socket, or where another process answers at it (with its id); io.
Result<sockaddr_un> free_control_address(const std::filesystem::path& path);

}  // namespace forcegate::emulated
