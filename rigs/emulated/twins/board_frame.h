#pragma once
// Frames of the board link as the board writes them, from the byte table of docs/protocol.md. Shares nothing with the
// harness's codec.

#include <cstdint>
#include <optional>
#include <span>

#include "rigs/emulated/twins/wire.h"

namespace forcegate::emulated {

struct BoardFrame {
  std::uint8_t version = 0x10;  ///< major << 4 | minor
  std::uint8_t type = 0;
  std::uint16_t sequence = 0;
  std::uint32_t t_us = 0;
  Bytes payload;
};

/// With the closing zero.
Bytes frame_bytes(const BoardFrame& frame);

/// One stretch between zeros; nullopt when it is no frame. Of which version is for the reader to judge.
std::optional<BoardFrame> frame_of(std::span<const std::uint8_t> stretch);

/// Little-endian writing and reading of payloads.
void put_u16(Bytes& out, unsigned v);
void put_u32(Bytes& out, std::uint32_t v);
void put_f32(Bytes& out, float v);
unsigned u16_at(std::span<const std::uint8_t> b, std::size_t at);
std::uint32_t u32_at(std::span<const std::uint8_t> b, std::size_t at);
float f32_at(std::span<const std::uint8_t> b, std::size_t at);

}  // namespace forcegate::emulated
