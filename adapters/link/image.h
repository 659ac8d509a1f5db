#pragma once
// What a firmware file is, judged by its content and never by its name.

#include <filesystem>
#include <string>

#include "hil/base/result.h"

namespace forcegate::link {

enum class ImageKind { host_shared_object, arm_executable };

struct Image {
  ImageKind kind = ImageKind::arm_executable;
  std::string port;      ///< "native", "block", "uart"; "" when an ARM image carries no marker
  std::string board;     ///< "mps2-an386" ...; "" without a marker
  std::string build_id;  ///< 40 hex digits of the marker "forcegate-build:"; "" without one
  std::string damage;    ///< "" or that the file is cut short (check_whole)
  bool ticks = false;    ///< marker "forcegate-tick:1": can be paced by its own 1 kHz clock
  double flash_bytes = 0.0, ram_bytes = 0.0;  ///< of an ARM image, from its section table
};

/// An ARM image says how it wants to be run by the text "forcegate-port:PORT:BOARD" anywhere in the file.
/// ErrorCode::usage with a hint when the file is missing, is no ELF file or is one for another machine.
Result<Image> inspect_image(const std::filesystem::path& path);

/// A file that is cut short is never what was built. ErrorCode::usage; for whoever loads the image.
Result<void> check_whole(const Image& image, const std::string& where);

/// An image that announces another build than the file holds is stale: what runs is not what was given.
/// ErrorCode::firmware; good when the file has no marker.
Result<void> check_build_id(const Image& image, const std::string& announced, const std::string& where);

}  // namespace forcegate::link
