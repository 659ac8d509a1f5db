#pragma once

#include <cstdint>

namespace forcegate::test {

/// About normal, of variance 1, the same on every machine.
struct Noise {
  std::uint32_t state = 1;
  double operator()() {
    double sum = 0.0;
    for (int k = 0; k < 12; ++k) sum += ((state = state * 1664525u + 1013904223u) >> 8) / 16777216.0 - 0.5;
    return sum;
  }
};

}  // namespace forcegate::test
