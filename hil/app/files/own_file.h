#pragma once
// A command that is given again replaces what it wrote before; a file of somebody else only when it is told to.

#include <filesystem>
#include <string_view>

#include "hil/base/result.h"

namespace forcegate {

/// First lines by which the writing command knows its file again.
inline constexpr std::string_view kMarkOfModel = "format = 1\nname = ", kMarkOfPage = "<meta name=\"color-scheme\" content=\"light dark\">\n<title>",
                                  kMarkOfCalibration = ": forcegate gate FIRMWARE --cal THIS", kMarkOfPicture = "<svg class=\"fig\"",
                                  kMarkOfSimulation = ",U_model", kMarkOfLeague = "\n \"size\": ";

/// Errors: usage, where a file that is not empty stands at `path` and `mark` is not in its first lines.
Result<void> check_own_file(const std::filesystem::path& path, std::string_view mark);

}  // namespace forcegate
