#include "rigs/emulated/twins/board_frame.h"

#include <bit>

namespace forcegate::emulated {
namespace {

// CRC-32, polynomial 0x04C11DB7 bit-reversed, a bit at a time.
std::uint32_t checksum_of(std::span<const std::uint8_t> bytes) {
  std::uint32_t remainder = ~0U;
  for (const std::uint8_t byte : bytes) {
    remainder ^= byte;
    for (int bit = 8; bit > 0; --bit)
      remainder = (remainder & 1U) ? 0xEDB88320U ^ (remainder >> 1) : remainder >> 1;
  }
  return ~remainder;
}

}  // namespace

void put_u16(Bytes& out, unsigned v) {
  out.push_back(static_cast<std::uint8_t>(v));
  out.push_back(static_cast<std::uint8_t>(v >> 8));
}
void put_u32(Bytes& out, std::uint32_t v) {
  put_u16(out, v & 0xFFFFU);
  put_u16(out, v >> 16);
}
void put_f32(Bytes& out, float v) { put_u32(out, std::bit_cast<std::uint32_t>(v)); }
unsigned u16_at(std::span<const std::uint8_t> b, std::size_t at) {
  return b[at] | static_cast<unsigned>(b[at + 1]) << 8;
}
std::uint32_t u32_at(std::span<const std::uint8_t> b, std::size_t at) {
  return u16_at(b, at) | u16_at(b, at + 2) << 16;
}
float f32_at(std::span<const std::uint8_t> b, std::size_t at) { return std::bit_cast<float>(u32_at(b, at)); }

Bytes frame_bytes(const BoardFrame& frame) {
  Bytes plain{frame.version, frame.type};
  put_u16(plain, frame.sequence);
  put_u32(plain, frame.t_us);
  plain.insert(plain.end(), frame.payload.begin(), frame.payload.end());
  put_u32(plain, checksum_of(plain));
  // Byte stuffing: each zero becomes the distance to the next one. At most 253 bytes, so one leading byte is enough.
  Bytes out(plain.size() + 2);
  std::size_t mark = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    out[i + 1] = plain[i];
    if (plain[i] != 0) continue;
    out[mark] = static_cast<std::uint8_t>(i + 1 - mark);
    mark = i + 1;
  }
  out[mark] = static_cast<std::uint8_t>(plain.size() + 1 - mark);
  out.back() = 0;
  return out;
}

std::optional<BoardFrame> frame_of(std::span<const std::uint8_t> stretch) {
  if (stretch.size() < 13 || stretch.size() > 254) return std::nullopt;
  Bytes plain(stretch.begin(), stretch.end());
  std::size_t mark = 0;
  while (mark < plain.size()) {
    const std::size_t next = mark + plain[mark];
    if (plain[mark] == 0 || next > plain.size()) return std::nullopt;
    plain[mark] = 0;
    mark = next;
  }
  plain.erase(plain.begin());
  const std::size_t body = plain.size() - 4;
  if (u32_at(plain, body) != checksum_of({plain.data(), body})) return std::nullopt;
  BoardFrame frame;
  frame.version = plain[0];
  frame.type = plain[1];
  frame.sequence = static_cast<std::uint16_t>(u16_at(plain, 2));
  frame.t_us = u32_at(plain, 4);
  frame.payload.assign(plain.begin() + 8, plain.begin() + static_cast<std::ptrdiff_t>(body));
  return frame;
}

}  // namespace forcegate::emulated
