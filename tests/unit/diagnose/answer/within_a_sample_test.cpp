// A shift of less than the time between two samples: channels that are read one after the other have it too.

#include <gtest/gtest.h>

#include "hil/diagnose/answer/reservation.h"

namespace forcegate::diagnose {
namespace {

// What is left of a lag, or of clocks that run apart over 2 s, where the samples are 1 ms apart.
double beside_samples(const char* effect, const char* parameter, double value) {
  Workspace w;
  w.input.records.resize(1);
  w.input.records[0].fast_t_s = {0.0, 0.001, 0.002};
  w.input.records[0].duration_s = 2.0;
  ResidualChannel channel;
  Finding f;
  f.effect = effect, f.probability = 0.9;
  f.parameters = {{parameter, value, 0.01 * value, "s"}};
  reserve(w, channel, {}, f);
  return f.probability;
}

TEST(WithinASample, IsNoClaim) {
  EXPECT_LT(beside_samples("lag", "lag_s", 0.0008), 0.5);
  EXPECT_EQ(beside_samples("lag", "lag_s", 0.0012), 0.9);
  EXPECT_LT(beside_samples("clock_skew", "skew", -0.0004), 0.5);
  EXPECT_EQ(beside_samples("clock_skew", "skew", 0.0006), 0.9);
}

}  // namespace
}  // namespace forcegate::diagnose
