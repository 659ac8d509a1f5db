#pragma once
// The firmware image that runs on the board's processor: a shared object in a process of its own (so that a crash
// silences the board and nothing else), or the Cortex-M image with its uart port in qemu-system-arm.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "rigs/emulated/twins/board_frame.h"

namespace forcegate::emulated {

class BoardImage {
 public:
  virtual ~BoardImage() = default;
  /// Answers HELLO, PARAM, RESET, ECHO and TIME (type and payload of the reply); nullopt: no answer.
  virtual std::optional<BoardFrame> answer(const BoardFrame& request) = 0;
  /// Payload of a SAMPLES frame from `first_index` on, without its first two bytes; nullopt: the image is silent.
  virtual std::optional<Bytes> convert(std::uint32_t first_index, std::span<const std::uint16_t> adc) = 0;
  /// How the image ended ("crashed with signal SEGV ..."); "" while it runs.
  virtual std::string fate() const { return {}; }
  /// Protocol version that it writes into its SAMPLES.
  virtual std::uint8_t version() const { return 0x10; }
};

/// An empty board: streams codes with force 0.
std::unique_ptr<BoardImage> blank_board();
/// ErrorCode::usage when the file is no image that a board can run.
Result<std::unique_ptr<BoardImage>> load_image(const std::string& path);

}  // namespace forcegate::emulated
