#pragma once
// Buffers that an image writes its answers into hold a mark before each call, so that a sample that it leaves out is
// seen and nothing of the block before is taken for its answer.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace forcegate {

/// A NaN that no arithmetic makes, and all eight flags, of which only five are defined.
inline constexpr std::uint32_t kUnansweredForceBits = 0x7FD0FACEU;
inline constexpr std::uint8_t kUnansweredFlags = 0xFF;

inline void mark_unanswered(std::span<float> force_N, std::span<std::uint8_t> flags) {
  for (float& force : force_N) force = std::bit_cast<float>(kUnansweredForceBits);
  for (std::uint8_t& flag : flags) flag = kUnansweredFlags;
}

struct Unanswered {
  std::size_t samples = 0, first = 0;  ///< how many have no force or no flags; the first of them
};

inline Unanswered count_unanswered(std::span<const float> force_N, std::span<const std::uint8_t> flags) {
  Unanswered out;
  for (std::size_t i = 0; i < force_N.size(); ++i)
    out.samples += (std::bit_cast<std::uint32_t>(force_N[i]) == kUnansweredForceBits) | (flags[i] == kUnansweredFlags);
  if (out.samples == 0) return out;
  while (std::bit_cast<std::uint32_t>(force_N[out.first]) != kUnansweredForceBits && flags[out.first] != kUnansweredFlags) ++out.first;
  return out;
}

}  // namespace forcegate
