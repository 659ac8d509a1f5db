#include "rigs/emulated/hidden/decay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace forcegate::hidden {
namespace {

// A film that feels 0.3 N less than what is pushed with, as behind contacts that close late: the loss turns about its own minimum, and a
// settled cycle stays a straight line.
TEST(Decay, TurnsAboutTheLowestForceThatTheFilmFeels) {
  RecordPlan plan;
  plan.kind = "sine";
  plan.dynamic = true;
  plan.low_N = 1.0, plan.high_N = 3.0, plan.f_min_Hz = 1.0;
  RecordTruth truth;
  const Climate climate;
  const RecordContext context{plan, truth, climate};
  for (const DecayLaw law : {DecayLaw::ratio, DecayLaw::root_f, DecayLaw::exponential_A, DecayLaw::absolute}) {
    Waves waves;
    waves.step_s = 0.005;
    for (int i = 0; i < 60000; ++i) {
      const double F = 2.0 - std::cos(2.0 * std::numbers::pi * 0.005 * i);
      waves.setpoint_N.push_back(F);
      waves.force_N.push_back(F);
      waves.film_N.push_back(F - 0.3);
    }
    apply_decay(law, waves, context);
    const std::size_t late = waves.size() - 200;
    const double low = waves.voltage_V[late], middle = waves.voltage_V[late + 50], high = waves.voltage_V[late + 100];
    EXPECT_NEAR(low, waves.voltage_V[200], 2e-3) << "the minima stay, " << to_string(law);
    EXPECT_NEAR(middle, 0.5 * (low + high), 3e-3) << to_string(law);
    EXPECT_LT(high - low, 0.5 * (waves.voltage_V[100] - waves.voltage_V[0])) << to_string(law);
  }
}

}  // namespace
}  // namespace forcegate::hidden
