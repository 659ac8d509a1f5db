#include "hil/diagnose/raw/repeated_blocks.h"

#include <algorithm>
#include <cmath>

#include "hil/base/rng.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

constexpr double kLsb_V = 0.0025;

// Cycles of 200 samples about 2 V, in codes.
std::vector<double> cycles(double noise_V) {
  std::vector<double> out;
  Rng rng(7, "codes");
  for (int i = 0; i < 20000; ++i) out.push_back(kLsb_V * std::round((2.0 + std::sin(0.0314159265358979 * i) + noise_V * rng.normal()) / kLsb_V));
  return out;
}

std::vector<double> ramp(std::size_t n) {
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(static_cast<double>(i));
  return out;
}

void send_again(std::vector<double>& U, std::size_t begin, std::size_t length, std::size_t before) {
  for (std::size_t i = begin; i < begin + length; ++i) U[i] = U[i - before];
}

TEST(RepeatedBlocks, AreFoundWhereTheyAreAndNowhereElse) {
  std::vector<double> U = cycles(2.0 * kLsb_V);
  const std::vector<double> F = ramp(U.size());
  EXPECT_TRUE(find_repeated_blocks(U, F, kLsb_V, 2.0 * kLsb_V).empty());
  send_again(U, 5000, 64, 64);
  send_again(U, 12000, 32, 96);  // two blocks ago, in a ring of three
  const std::vector<RepeatedBlock> found = find_repeated_blocks(U, F, kLsb_V, 2.0 * kLsb_V);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_LE(found[0].begin, 5000u);
  EXPECT_GE(found[0].begin, 4998u) << "one or two more are equal by chance";
  EXPECT_GE(found[0].end, 5064u);
  EXPECT_EQ(found[0].before, 64u);
  EXPECT_EQ(found[1].before, 96u);
}

TEST(RepeatedBlocks, ASwingThatComesByWithoutNoiseIsNone) {
  for (const double noise : {0.0, 0.1, 0.5}) {
    const std::vector<double> U = cycles(noise * kLsb_V);
    EXPECT_TRUE(find_repeated_blocks(U, ramp(U.size()), kLsb_V, 1.5 * kLsb_V).empty()) << "taken for noisier than it is: " << noise;
  }
  std::vector<double> U = cycles(0.5 * kLsb_V);
  send_again(U, 5000, 64, 64);
  EXPECT_TRUE(find_repeated_blocks(U, ramp(U.size()), kLsb_V, 0.5 * kLsb_V).empty()) << "not asked";
}

TEST(RepeatedBlocks, ARestBetweenTwoCodesIsNone) {
  std::vector<double> U = cycles(2.0 * kLsb_V);
  Rng rng(3, "rest");
  for (std::size_t i = 0; i < U.size(); ++i)
    if (i % 2000 < 900) U[i] = 0.5 + (rng.normal() > 0.0 ? kLsb_V : 0.0);
  EXPECT_TRUE(find_repeated_blocks(U, ramp(U.size()), kLsb_V, 2.0 * kLsb_V).empty());
}

// Samples that far apart are at different levels nearly everywhere, and at one level in the few places where ten in a row are equal by chance.
TEST(RepeatedBlocks, ALongHoldThatCreepsOverAFewCodesHasNone) {
  for (const double noise : {1.2, 1.6})
    for (int seed = 1; seed <= 4; ++seed) {
      Rng rng(static_cast<std::uint64_t>(seed), "creeping hold");
      std::vector<double> U;
      for (int i = 0; i < 60000; ++i) U.push_back(kLsb_V * std::round((1.0 + 0.1 * std::log1p(0.01 * i)) / kLsb_V + noise * rng.normal()));
      EXPECT_TRUE(find_repeated_blocks(U, ramp(U.size()), kLsb_V, noise * kLsb_V).empty()) << noise << " " << seed;
    }
}

TEST(RepeatedBlocks, AHeldValueIsNoneAndNoMoreAreRowsThatWereWrittenTwice) {
  std::vector<double> U = cycles(2.0 * kLsb_V), F = cycles(3.0 * kLsb_V);
  for (std::size_t i = 3000; i < 3100; ++i) U[i] = U[3000];
  EXPECT_TRUE(find_repeated_blocks(U, F, kLsb_V, 2.0 * kLsb_V).empty());
  send_again(U, 7000, 50, 50);
  send_again(F, 7000, 50, 50);
  EXPECT_TRUE(find_repeated_blocks(U, F, kLsb_V, 2.0 * kLsb_V).empty());
}

TEST(RepeatedBlocks, TooShortARecordHasNone) {
  for (std::size_t n = 0; n < 24; ++n) {
    std::vector<double> U = cycles(2.0 * kLsb_V);
    U.resize(n);
    EXPECT_TRUE(find_repeated_blocks(U, ramp(n), kLsb_V, 2.0 * kLsb_V).empty()) << n;
  }
}

Diagnosis answer_with_blocks(std::size_t each, std::size_t records) {
  Campaign c = make_campaign(51, [](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    for (const double f : F) U.push_back(2.0 * f + 0.2);
    return U;
  });
  for (std::size_t k = 0; k < records; ++k)
    for (std::size_t j = 0; j < each; ++j) send_again(c.records[k].trace.find("U")->value, 1500 + 1700 * j + 311 * k, 40, 40);
  return answer(std::move(c));
}

TEST(RepeatedBlocks, AreDropoutsWhereTheyComeAgain) {
  const Diagnosis d = answer_with_blocks(3, 3);
  EXPECT_GE(probability(d, "dropouts"), 0.9) << told(d);
}

TEST(RepeatedBlocks, OneAloneIsLeftOutAndNoted) {
  const Diagnosis d = answer_with_blocks(1, 1);
  EXPECT_EQ(probability(d, "dropouts"), 0.0) << told(d);
  EXPECT_TRUE(std::ranges::any_of(d.notes, [](const std::string& note) { return note.find("40 in blocks that were sent before") != std::string::npos; })) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
