#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hil/base/rng.h"

namespace forcegate::emulated {

/// White Gaussian noise for 1 kHz channels at 1 to 2 ns a number: picks from a fixed sample of 8192 normal
/// numbers that has mean 0 and standard deviation 1 exactly; four picks a random word. Its largest value is
/// about 3.9.
class WhiteNoise {
 public:
  WhiteNoise(std::uint64_t seed, const char* stream) : rng_(seed, stream), table_(&table()) {}

  double next() {
    if (left_ == 0) {
      word_ = rng_.next();
      left_ = 4;
    }
    --left_;
    const auto at = static_cast<std::size_t>(word_ & (kSize - 1));
    word_ >>= 16;
    return (*table_)[at];
  }

 private:
  static constexpr std::size_t kSize = 8192;
  using Table = std::array<double, kSize>;

  static const Table& table() {
    static const Table values = [] {
      Table t;
      Rng rng(8192, "white_noise_table");
      double squares = 0.0;
      for (std::size_t i = 0; i < kSize; i += 2) {  // antithetic pairs: the mean is 0
        t[i] = rng.normal();
        t[i + 1] = -t[i];
        squares += 2.0 * t[i] * t[i];
      }
      const double scale = 1.0 / __builtin_sqrt(squares / static_cast<double>(kSize));
      for (double& v : t) v *= scale;
      return t;
    }();
    return values;
  }

  Rng rng_;
  const Table* table_;
  std::uint64_t word_ = 0;
  int left_ = 0;
};

}  // namespace forcegate::emulated
