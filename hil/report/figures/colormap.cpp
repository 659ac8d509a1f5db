#include "hil/report/figures/colormap.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hil/report/figures/style.h"

namespace forcegate::figures {
namespace {

using Rgb = std::array<double, 3>;

// Ten equidistant points of cividis, linear between them.
constexpr std::array<Rgb, 10> kCividis{{{0, 32, 77},
                                        {0, 51, 111},
                                        {57, 72, 107},
                                        {87, 92, 109},
                                        {112, 113, 115},
                                        {138, 135, 121},
                                        {166, 157, 117},
                                        {196, 181, 108},
                                        {228, 207, 91},
                                        {255, 234, 70}}};
constexpr std::array<Rgb, 5> kDiverging{
    {{0, 84, 140}, {86, 160, 211}, {247, 247, 247}, {236, 146, 84}, {176, 70, 0}}};

template <std::size_t N>
std::string interpolate(const std::array<Rgb, N>& table, int level) {
  const double at = std::clamp(static_cast<double>(level) / (kColourLevels - 1), 0.0, 1.0) * (N - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(at), N - 2);
  const double f = at - static_cast<double>(i);
  const auto mix = [&](int c) {
    return static_cast<int>(std::lround(table[i][c] * (1.0 - f) + table[i + 1][c] * f));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2));
}

}  // namespace

int colour_level(double fraction) {
  if (std::isnan(fraction)) return -1;
  return static_cast<int>(std::lround(std::clamp(fraction, 0.0, 1.0) * (kColourLevels - 1)));
}

std::string sequential_colour(int level) { return interpolate(kCividis, level); }
std::string diverging_colour(int level) { return interpolate(kDiverging, level); }

std::string ink_on(const std::string& colour) {
  return contrast_ratio(colour, "#000000") >= contrast_ratio(colour, "#ffffff") ? "#000" : "#fff";
}

}  // namespace forcegate::figures
