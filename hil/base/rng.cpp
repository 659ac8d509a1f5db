#include "hil/base/rng.h"

#include <array>
#include <bit>

#include "hil/base/mixed_bits.h"
#include "hil/base/portable_math.h"

namespace forcegate {
namespace {

std::uint64_t splitmix(std::uint64_t& state) { return mixed_bits(state += kMixStep); }

constexpr int kLayers = 256;
constexpr double kTail = 3.6541528853610088;  // start of the tail for 256 layers
constexpr double kArea = 0.00492867323399;    // area of each layer

struct Ziggurat {
  std::array<double, kLayers + 1> x;
  std::array<double, kLayers + 1> y;
  Ziggurat() {
    const auto density = [](double v) { return portable::exp(-0.5 * v * v); };
    x[0] = kArea / density(kTail);
    x[1] = kTail;
    for (int i = 2; i < kLayers; ++i)
      x[static_cast<std::size_t>(i)] = sqrt_of_minus_two_log(kArea / x[static_cast<std::size_t>(i - 1)] +
                                                             density(x[static_cast<std::size_t>(i - 1)]));
    x[kLayers] = 0.0;
    for (int i = 0; i <= kLayers; ++i)
      y[static_cast<std::size_t>(i)] = density(x[static_cast<std::size_t>(i)]);
  }
  static double sqrt_of_minus_two_log(double v) {
    const double a = -2.0 * portable::log(v);
    return a > 0 ? __builtin_sqrt(a) : 0.0;  // sqrt is exactly rounded by IEEE 754
  }
};

const Ziggurat& ziggurat() {
  static const Ziggurat table;
  return table;
}

}  // namespace

std::uint64_t mix_seed(std::uint64_t seed, std::string_view text) {
  std::uint64_t h = 0xCBF29CE484222325ULL ^ seed;
  for (const char c : text) {
    h ^= static_cast<unsigned char>(c);
    h *= 0x100000001B3ULL;
  }
  std::uint64_t state = h ^ std::rotl(seed, 32);
  return splitmix(state);
}

Rng::Rng(std::uint64_t seed, std::string_view stream) {
  std::uint64_t state = stream.empty() ? seed : mix_seed(seed, stream);
  for (auto& word : s_) word = splitmix(state);
}

std::uint64_t Rng::below(std::uint64_t n) {
  const std::uint64_t limit = ~std::uint64_t{0} - (~std::uint64_t{0} % n + 1) % n;
  std::uint64_t v = next();
  while (v > limit) v = next();
  return v % n;
}

double Rng::normal() {
  const Ziggurat& z = ziggurat();
  while (true) {
    const std::uint64_t bits = next();
    const auto i = static_cast<std::size_t>(bits & 0xFF);
    const double sign = (bits & 0x100) ? -1.0 : 1.0;
    const double u = static_cast<double>(bits >> 11) * 0x1.0p-53;
    const double x = u * z.x[i];
    if (x < z.x[i + 1]) return sign * x;
    if (i == 0) {
      double a, b;
      do {
        a = -portable::log(1.0 - uniform()) / kTail;
        b = -portable::log(1.0 - uniform());
      } while (b + b < a * a);
      return sign * (kTail + a);
    }
    if (z.y[i] + uniform() * (z.y[i + 1] - z.y[i]) < portable::exp(-0.5 * x * x)) return sign * x;
  }
}

}  // namespace forcegate
