#pragma once
// Layout of journal frames, shared by the writer and the reader. Little-endian (checked at compile time).

#include <zlib.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace forcegate::journal {

static_assert(std::endian::native == std::endian::little,
              "the journal is written in the processor's byte order");

inline constexpr char kMagic[8] = {'F', 'G', 'J', 'O', 'U', 'R', 'N', '\n'};
inline constexpr std::uint32_t kMarker = 0x454D5246;  // "FRME"
inline constexpr std::size_t kLargestFrame = std::size_t{16} << 20;

struct FrameHead {
  std::uint32_t marker, length;
  std::uint16_t device, kind;
  std::uint32_t reserved;
  std::uint64_t time_ns;
};
static_assert(sizeof(FrameHead) == 24);

inline std::uint32_t crc(std::uint32_t seed, const void* data, std::size_t n) {
  if (n == 0) return seed;  // zlib gives 0 for no data at a null pointer
  return static_cast<std::uint32_t>(::crc32(seed, static_cast<const Bytef*>(data), static_cast<uInt>(n)));
}

/// Over the head (without its marker) and the payload.
inline std::uint32_t frame_crc(const FrameHead& head, const void* payload) {
  const auto* bytes = reinterpret_cast<const std::byte*>(&head);
  return crc(crc(0, bytes + 4, sizeof head - 4), payload, head.length);
}

}  // namespace forcegate::journal
