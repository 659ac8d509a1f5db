#pragma once

#include <cstdint>

namespace forcegate {

/// What splitmix64 counts by: its n-th number is mixed_bits(n * kMixStep).
inline constexpr std::uint64_t kMixStep = 0x9E3779B97F4A7C15u;

/// One to one, and every bit of the result hangs on every bit of `x`: the finish of splitmix64 (Steele, Lea and Flood 2014).
constexpr std::uint64_t mixed_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

}  // namespace forcegate
