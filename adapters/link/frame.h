#pragma once
// Frames of the link to a device under test. Decoded, little-endian, at most 253 bytes:
//   version u8 (major << 4 | minor) | type u8 | sequence u16 | t_us u32 | payload 0...241 | crc32 u32
// then COBS and a closing 0x00. docs/protocol.md has worked examples.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace forcegate::link {

inline constexpr std::uint8_t kVersion = 0x10;
inline constexpr std::size_t kPayloadMax = 241;
inline constexpr std::size_t kEncodedMax = 255;  ///< with the closing zero

struct Frame {
  std::uint8_t version = kVersion;
  std::uint8_t type = 0;
  std::uint16_t sequence = 0;
  std::uint32_t t_us = 0;
  std::vector<std::uint8_t> payload;
};

/// payload.size() <= kPayloadMax (asserted).
std::vector<std::uint8_t> encode(const Frame& frame);

enum class Parse { value, invalid, need_more };

struct ParseResult {
  Parse kind = Parse::need_more;
  std::size_t consumed = 0;  ///< bytes to drop from the front of the buffer; 0 only with need_more
  Frame frame;               ///< valid with Parse::value
  std::string_view reason;   ///< with Parse::invalid: "crc", "cobs", "too short", "too long"
};

/// Looks at the front of a byte stream. Empty stretches between zeros are skipped silently. Never accepts a
/// frame whose CRC does not fit; after `invalid` the stream goes on behind the next zero.
ParseResult parse(std::span<const std::uint8_t> stream);

}  // namespace forcegate::link
