// A shift of less than half the time between two samples: channels that are read one after the other have it too.

#include <gtest/gtest.h>

#include "hil/diagnose/answer/reservation.h"

namespace forcegate::diagnose {
namespace {

// What is left of a shift where the samples are 1 ms apart.
double of_shift(const char* effect, double shift_s) {
  Workspace w;
  w.input.records.resize(1);
  w.input.records[0].fast_t_s = {0.0, 0.001, 0.002};
  ResidualChannel channel;
  Finding f;
  f.effect = effect, f.probability = 0.9;
  f.parameters = {{std::string(effect) + "_s", shift_s, 0.01 * shift_s, "s"}};
  reserve(w, channel, {}, f);
  return f.probability;
}

TEST(WithinASample, IsNoClaim) {
  for (const char* effect : {"lag", "delay"}) {
    EXPECT_LT(of_shift(effect, 0.0004), 0.5) << effect;
    EXPECT_EQ(of_shift(effect, 0.0006), 0.9) << effect;
  }
}

}  // namespace
}  // namespace forcegate::diagnose
