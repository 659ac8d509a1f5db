#pragma once
// Consistent overhead byte stuffing (Cheshire and Baker 1999): removes zero bytes, so that 0x00 can end a
// frame.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace forcegate::link {

/// Without the closing 0x00. One byte longer than the input for every 254 bytes begun.
std::vector<std::uint8_t> cobs_encode(std::span<const std::uint8_t> bytes);

/// `bytes` without the closing 0x00. nullopt when they are no COBS sequence.
std::optional<std::vector<std::uint8_t>> cobs_decode(std::span<const std::uint8_t> bytes);

}  // namespace forcegate::link
