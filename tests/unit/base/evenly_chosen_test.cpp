#include "hil/base/evenly_chosen.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "hil/base/quantile.h"

namespace forcegate {
namespace {

std::vector<std::size_t> chosen_of(std::size_t size, std::size_t most) {
  EvenlyChosen choice(size, most);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < size; ++i)
    if (choice.next()) out.push_back(i);
  return out;
}

TEST(EvenlyChosen, AreAllWhereThereAreFewAndNeverMoreThanTwiceAsMany) {
  for (const std::size_t size : {1u, 7u, 1999u, 2000u, 3999u}) EXPECT_EQ(chosen_of(size, 2000).size(), size);
  for (const std::size_t size : {4000u, 5999u, 250000u, 2000000u}) {
    const std::size_t n = chosen_of(size, 2000).size();
    EXPECT_GE(n + 1, 2000u) << size;
    EXPECT_LE(n, 4000u) << size;
  }
  EXPECT_TRUE(chosen_of(0, 10).empty());
  EXPECT_EQ(chosen_of(50, 0).size(), 1u);
}

TEST(EvenlyChosen, AreSpreadOverAllAndTheSameEveryTime) {
  const std::vector<std::size_t> once = chosen_of(100000, 1000);
  EXPECT_EQ(once, chosen_of(100000, 1000));
  EXPECT_EQ(once.front(), 0u) << "where there is any sample there is a chosen one";
  for (std::size_t k = 0; k < once.size(); ++k) EXPECT_EQ(once[k] / 100, k) << "one of each block";
}

TEST(EvenlyChosen, NoPeriodStaysInStep) {
  constexpr std::size_t kSize = 250000, kMost = 2000, kBlock = kSize / kMost;
  const std::vector<std::size_t> chosen = chosen_of(kSize, kMost);
  std::vector<double> periods;
  for (int n = 2; n <= 400; ++n) periods.push_back(n);
  for (int n = 1; n <= 200; ++n)  // those that divide the block, and its multiples with the golden ratio's
    for (const double of : {1.0 / n, n + 0.0, n / std::numbers::phi, std::numbers::phi / n}) periods.push_back(of * kBlock);
  for (const double period : periods) {
    if (period < 2.0 || period > 0.05 * kSize) continue;
    std::vector<double> all, some;
    for (std::size_t i = 0; i < kSize; i += period == std::floor(period) ? 1 : 7)
      all.push_back(std::sin(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.3) / period));
    for (const std::size_t i : chosen) some.push_back(std::sin(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.3) / period));
    const auto [low, high] = quantiles(all, 0.01, 0.99);
    const auto [low_of_some, high_of_some] = quantiles(some, 0.01, 0.99);
    EXPECT_NEAR(low_of_some, low, 0.02) << period;
    EXPECT_NEAR(high_of_some, high, 0.02) << period;
    EXPECT_NEAR(*std::ranges::max_element(some), *std::ranges::max_element(all), 0.01) << period;
  }
}

}  // namespace
}  // namespace forcegate
