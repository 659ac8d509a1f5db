#pragma once
// Seeded random numbers with the same bits on every machine: xoshiro256++ (Blackman and Vigna 2019)
// seeded by splitmix64, and a ziggurat normal (Marsaglia and Tsang 2000) whose tables are made with
// portable functions. There is no generator without a seed.

#include <bit>
#include <cstdint>
#include <string_view>

namespace forcegate {

class Rng {
 public:
  /// Independent streams for one seed: Rng(seed, "adc_noise"), Rng(seed, "specimen/17").
  explicit Rng(std::uint64_t seed, std::string_view stream = {});

  std::uint64_t next() {
    const std::uint64_t result = std::rotl(s_[0] + s_[3], 23) + s_[0];
    const std::uint64_t t = s_[1] << 17;
    s_[2] ^= s_[0];
    s_[3] ^= s_[1];
    s_[1] ^= s_[2];
    s_[0] ^= s_[3];
    s_[2] ^= t;
    s_[3] = std::rotl(s_[3], 45);
    return result;
  }

  /// Uniform in [0, 1), 53 bits.
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Uniform integer in [0, n), n > 0.
  std::uint64_t below(std::uint64_t n);

  /// Standard normal.
  double normal();
  double normal(double mean, double sd) { return mean + sd * normal(); }

 private:
  std::uint64_t s_[4];
};

/// 64-bit mix of a seed and a text, for deriving child seeds: mix_seed(seed, "case/sine_05").
std::uint64_t mix_seed(std::uint64_t seed, std::string_view text);

}  // namespace forcegate
