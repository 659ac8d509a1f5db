#pragma once
// A byte stream to a device: serial port, pseudo terminal, Unix socket. Knows nothing of frames.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "hil/base/result.h"

namespace forcegate {

class Transport {
 public:
  virtual ~Transport() = default;

  /// Sends all bytes. ErrorCode::timeout when the far end takes none for timeout_s, ErrorCode::io when it is gone.
  virtual Result<void> write(std::span<const std::uint8_t> bytes, double timeout_s) = 0;

  /// Waits at most timeout_s for at least one byte; returns how many were read, 0 = none in that time.
  /// ErrorCode::io when the far end is gone.
  virtual Result<std::size_t> read(std::span<std::uint8_t> into, double timeout_s) = 0;

  /// "unix:/tmp/x", "serial:/dev/ttyUSB0 115200 8N1"; for messages.
  virtual std::string name() const = 0;
};

}  // namespace forcegate
