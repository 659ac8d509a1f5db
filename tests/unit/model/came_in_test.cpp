// A converter whose upper bits weigh wrong: what came in is found from readings that jump.

#include "hil/model/came_in.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/model/rows.h"
#include "synthetic.h"

namespace forcegate {
namespace {

constexpr double kRange_V = 10.0, kBits_V[] = {-0.9, -0.7, -0.4};

double read(double came_in_V) {
  const auto bits = upper_bits(came_in_V / kRange_V);
  double out = came_in_V;
  for (std::size_t b = 0; b < 3; ++b) out += kBits_V[b] * bits[b];
  return out;
}

CampaignInput through_converter(double slope, double level) {
  auto made = make_campaign_input(test::campaign([=](double, double F) { return read(level + slope * F); }));
  EXPECT_TRUE(made.has_value());
  for (RecordInput& r : made->records) r.decay.assign(r.rows(), 1.0);
  return std::move(*made);
}

TEST(UpperBits, OfAShareOfTheRange) {
  EXPECT_EQ(upper_bits(0.0), (std::array<double, kUpperBits>{0, 0, 0, 0}));
  EXPECT_EQ(upper_bits(0.5), (std::array<double, kUpperBits>{1, 0, 0, 0}));
  EXPECT_EQ(upper_bits(0.7), (std::array<double, kUpperBits>{1, 0, 1, 1}));
}

// Of the places where the reading jumps; between them the bits do not tell.
void expect_found(double slope, double level) {
  const CameInLine line = find_came_in(through_converter(slope, level), 0.0, kRange_V);
  for (const double jump_V : {2.5, 5.0, 7.5})
    EXPECT_NEAR((jump_V - line.level_V) / line.slope_V_per_N, (jump_V - level) / slope, 0.06) << jump_V << " V";
}

TEST(CameIn, IsFoundTogetherWithTheJumps) { expect_found(2.1, 0.3); }

TEST(CameIn, OfAnOutputThatFallsWithTheForce) { expect_found(-2.0, 9.3); }

TEST(CameIn, OfNothingIsNoLine) { EXPECT_EQ(find_came_in({}, 0.0, kRange_V).slope_V_per_N, 0.0); }

}  // namespace
}  // namespace forcegate
