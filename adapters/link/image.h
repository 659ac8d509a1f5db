#pragma once
// What a firmware file is, judged by its content and never by its name.

#include <filesystem>
#include <string>

#include "hil/base/result.h"

namespace forcegate::link {

enum class ImageKind { host_shared_object, arm_executable };

struct Image {
  ImageKind kind = ImageKind::arm_executable;
  std::string port;   ///< "native", "block", "uart"; "" when an ARM image carries no marker
  std::string board;  ///< "mps2-an386" ...; "" without a marker
};

/// An ARM image says how it wants to be run by the text "forcegate-port:PORT:BOARD" anywhere in the file.
/// ErrorCode::usage with a hint when the file is missing, is no ELF file or is one for another machine.
Result<Image> inspect_image(const std::filesystem::path& path);

}  // namespace forcegate::link
