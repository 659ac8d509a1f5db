#pragma once
// Serial ports and pseudo terminals through termios2, so that any bit rate works (1.25 Mbaud included).

#include <filesystem>
#include <memory>

#include "adapters/transport/descriptor.h"

namespace forcegate {

enum class Parity { none, even, odd };

struct SerialSettings {
  unsigned baud = 115200;
  Parity parity = Parity::none;
};

/// Raw 8-bit line, one stop bit, exclusive by flock. ErrorCode::device with a hint when another program holds
/// the port or the rate cannot be had (it is read back).
Result<std::unique_ptr<Transport>> open_serial(const std::filesystem::path& port,
                                               const SerialSettings& settings);

/// A pseudo terminal: our end and the path of the other one.
struct PseudoTerminal {
  std::unique_ptr<Transport> master;
  std::filesystem::path slave;
};
Result<PseudoTerminal> open_pseudo_terminal();

}  // namespace forcegate
