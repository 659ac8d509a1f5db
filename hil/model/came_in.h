#pragma once
// What came in to a converter whose upper bits have wrong weights. The reading jumps by several percent there, so neither the reading nor
// a straight line through it tells which code was meant: the line is found together with the jumps.

#include <array>
#include <cstddef>
#include <vector>

#include "hil/model/record_input.h"

namespace forcegate {

inline constexpr std::size_t kUpperBits = 4;

/// The upper bits, highest first, of a share of the converter's range, 0 to just below 1.
std::array<double, kUpperBits> upper_bits(double share);

/// Of the declared range, else zero.
double lowest_code_V(const BenchFacts& bench);

/// x = level_V + slope_V_per_N * base force, volt.
struct CameInLine {
  double slope_V_per_N = 0.0, level_V = 0.0;
};

/// The line whose bits leave the least of U beside a line of its own in each record: least squares over slope and level, by a grid about
/// the straight line through all readings (slope +-30 % about the lowest reading, level +-6 % of the range) that is then halved around its best place.
/// `low_V`, `range_V`: of the converter.
CameInLine find_came_in(const CampaignInput& campaign, double low_V, double range_V);

}  // namespace forcegate
