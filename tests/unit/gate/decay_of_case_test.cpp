// The decay that a report tells of a case.

#include <gtest/gtest.h>

#include <cmath>

#include "hil/gate/case_result.h"

namespace forcegate {
namespace {

// Turns of an open-loop record whose raw sensor loses two thirds of its swing; `height_N` of the n-th maximum of the ATI.
CaseResult result_of(double (*height_N)(int n)) {
  CaseRecord record;
  record.rig.emulated = true;
  record.facts.dynamic = true;
  for (int n = 0; n < 400; ++n) {
    const double t = 2.0 * n, low = 1.0, high = height_N(n), left = (std::exp(-0.006 * t) + 0.5) / 1.5;
    CasePair pair;
    pair.maximum = true, pair.t_s = t + 1.0, pair.ati_N = high, pair.raw_N = low + (high - low) * left;
    record.pairs.push_back(pair);
    pair.maximum = false, pair.t_s = t + 2.0, pair.ati_N = low, pair.raw_N = low;
    record.pairs.push_back(pair);
  }
  PlanCase planned;
  planned.loop = LoopMode::open;
  return to_case_result(planned, {}, std::move(record), {}, false);
}

TEST(DecayOfCase, IsToldOfCyclesOfOneHeight) {
  const CaseResult sine = result_of([](int n) { return n == 0 ? 3.5 : 4.0 + 0.01 * (n % 3); });
  ASSERT_TRUE(sine.decay.valid);
  EXPECT_NEAR(sine.decay.b_per_s, 0.006, 0.0005);
}

TEST(DecayOfCase, IsNotToldWhereTheForceItselfGoesUpAndDown) {
  EXPECT_FALSE(result_of([](int n) { return 3.0 + std::sin(0.7 * n); }).decay.valid);
}

}  // namespace
}  // namespace forcegate
