#include "adapters/link/frame.h"

#include <algorithm>
#include <cassert>

#include "adapters/link/cobs.h"
#include "adapters/link/crc32.h"

namespace forcegate::link {
namespace {

constexpr std::size_t kHeader = 8, kCrc = 4;

void append_u32(std::vector<std::uint8_t>& out, std::uint32_t v) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::uint8_t>(v >> shift));
}

std::uint32_t u32_at(std::span<const std::uint8_t> b, std::size_t i) {
  return static_cast<std::uint32_t>(b[i]) | static_cast<std::uint32_t>(b[i + 1]) << 8 |
         static_cast<std::uint32_t>(b[i + 2]) << 16 | static_cast<std::uint32_t>(b[i + 3]) << 24;
}

}  // namespace

std::vector<std::uint8_t> encode(const Frame& frame) {
  assert(frame.payload.size() <= kPayloadMax);
  std::vector<std::uint8_t> raw{frame.version, frame.type, static_cast<std::uint8_t>(frame.sequence),
                                static_cast<std::uint8_t>(frame.sequence >> 8)};
  append_u32(raw, frame.t_us);
  raw.insert(raw.end(), frame.payload.begin(), frame.payload.end());
  append_u32(raw, crc32(raw));
  std::vector<std::uint8_t> out = cobs_encode(raw);
  out.push_back(0);
  return out;
}

ParseResult parse(std::span<const std::uint8_t> stream) {
  std::size_t begin = 0;
  while (begin < stream.size() && stream[begin] == 0) ++begin;
  const auto first = stream.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto zero = std::find(first, stream.end(), std::uint8_t{0});
  ParseResult result;
  if (zero == stream.end()) {
    result.consumed = begin;
    if (stream.size() - begin >=
        kEncodedMax) {  // no frame is that long: drop it, its tail will be refused too
      result.kind = Parse::invalid;
      result.consumed = stream.size();
      result.reason = "too long";
    }
    return result;
  }
  const auto size = static_cast<std::size_t>(zero - first);
  result.consumed = begin + size + 1;
  result.kind = Parse::invalid;
  if (size > kEncodedMax - 1) {
    result.reason = "too long";
    return result;
  }
  const auto raw = cobs_decode(stream.subspan(begin, size));
  if (!raw) {
    result.reason = "cobs";
    return result;
  }
  if (raw->size() < kHeader + kCrc) {
    result.reason = "too short";
    return result;
  }
  const std::span<const std::uint8_t> bytes(*raw);
  if (u32_at(bytes, bytes.size() - kCrc) != crc32(bytes.first(bytes.size() - kCrc))) {
    result.reason = "crc";
    return result;
  }
  result.kind = Parse::value;
  result.frame.version = bytes[0];
  result.frame.type = bytes[1];
  result.frame.sequence = static_cast<std::uint16_t>(bytes[2] | bytes[3] << 8);
  result.frame.t_us = u32_at(bytes, 4);
  result.frame.payload.assign(raw->begin() + kHeader, raw->end() - kCrc);
  return result;
}

}  // namespace forcegate::link
