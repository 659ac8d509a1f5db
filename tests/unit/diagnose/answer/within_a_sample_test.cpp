// A shift of less than the time between two samples: channels that are read one after the other have it too.

#include <gtest/gtest.h>

#include "hil/diagnose/answer/reservation.h"

namespace forcegate::diagnose {
namespace {

// What is left of a lag where the samples are 1 ms apart.
double of_lag(double lag_s) {
  Workspace w;
  w.input.records.resize(1);
  w.input.records[0].fast_t_s = {0.0, 0.001, 0.002};
  ResidualChannel channel;
  Finding f;
  f.effect = "lag", f.probability = 0.9;
  f.parameters = {{"lag_s", lag_s, 0.01 * lag_s, "s"}};
  reserve(w, channel, {}, f);
  return f.probability;
}

TEST(WithinASample, IsNoClaim) {
  EXPECT_LT(of_lag(0.0008), 0.5);
  EXPECT_EQ(of_lag(0.0012), 0.9);
}

}  // namespace
}  // namespace forcegate::diagnose
