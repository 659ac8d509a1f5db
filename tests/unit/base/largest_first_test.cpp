#include "hil/base/largest_first.h"

#include <gtest/gtest.h>

namespace forcegate {
namespace {

TEST(LargestFirst, BeginsWithTheLargestAndKeepsTheOrderOfEquals) {
  std::vector<std::size_t> seen;
  parallel_for_largest_first(std::vector<std::size_t>{3, 9, 3, 0, 12}, 1,
                             [&](std::size_t i) { seen.push_back(i); });
  EXPECT_EQ(seen, (std::vector<std::size_t>{4, 1, 0, 2, 3}));
}

TEST(LargestFirst, CallsEveryItemOnceOnAnyNumberOfThreads) {
  const std::vector<std::size_t> size{5, 1, 4, 4, 2, 8, 0, 1};
  for (const unsigned threads : {1u, 2u, 3u, 16u}) {
    std::vector<int> calls(size.size(), 0);
    parallel_for_largest_first(size, threads, [&](std::size_t i) { ++calls[i]; });
    EXPECT_EQ(calls, std::vector<int>(size.size(), 1)) << threads;
  }
}

}  // namespace
}  // namespace forcegate
