#pragma once

#include <cstdint>
#include <span>

namespace forcegate::link {

/// CRC-32 (IEEE 802.3: reflected, polynomial 0xEDB88320, start and final xor 0xFFFFFFFF). "123456789" ->
/// 0xCBF43926.
std::uint32_t crc32(std::span<const std::uint8_t> bytes);

}  // namespace forcegate::link
