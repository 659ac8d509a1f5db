#include "hil/base/quantile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace forcegate {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(Quantile, IsTheFiniteValueNextToIt) {
  EXPECT_EQ(quantile({5.0, kNone, 1.0, 3.0, 2.0, 4.0}, 0.25), 2.0);
  EXPECT_EQ(quantile({5.0, 1.0}, 1.0), 5.0);
  EXPECT_EQ(quantiles({4.0, 2.0, 3.0, 1.0}, 0.0, 1.0), (std::array{1.0, 4.0}));
  EXPECT_TRUE(std::isnan(quantile({kNone}, 0.5)));
}

TEST(Median, OfAnEvenNumberIsTheUpperOfTheMiddle) {
  EXPECT_EQ(median({4.0, 1.0, 3.0, 2.0}), 3.0);
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
}

TEST(DeviationOfMagnitudes, IsThatOfNormalNoiseWhateverItsOutliers) {
  EXPECT_NEAR(deviation_of_magnitudes({0.6745, 0.1, 1e6}), 1.0, 1e-4);
  EXPECT_EQ(deviation_of_magnitudes({}), 0.0);
}

}  // namespace
}  // namespace forcegate
