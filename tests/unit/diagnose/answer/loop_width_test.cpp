// The width that is told of a loop, beside what the loop explains.

#include <cmath>

#include "hil/diagnose/answer/reservation.h"
#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

// A claimed loop of `width_pct` of the span that makes 0.1 % of it.
double claimed_loop(double width_pct) {
  Workspace w;
  ResidualChannel channel;
  channel.scale = 5.0;
  Finding f;
  f.effect = "hysteresis";
  f.probability = 0.98;
  f.effect_rms = 0.001 * channel.scale;
  f.parameters = {{"loop_width", width_pct, 0.1 * width_pct, "% of span"}};
  reserve(w, channel, {}, f);
  return f.probability;
}

TEST(LoopWidth, FarBeyondWhatItExplainsIsNoLoop) {
  EXPECT_EQ(claimed_loop(1.0), 0.98);
  EXPECT_LT(claimed_loop(30.0), 0.5);
}

// Ten samples of each cycle of a bent sensor, two to a row: what the curve does within a row is neither force nor rate of the row.
TEST(LoopWidth, ABentSensorUnderFastCyclesHasNoLoopOfHalfItsSpan) {
  const auto bent = [](const std::vector<double>&, const std::vector<double>& F) {
    std::vector<double> U;
    for (const double f : F) U.push_back(2.0 * f + f * f / 30.0 + 0.5);
    return U;
  };
  const Diagnosis d = answer(recording(100.0, 100000, [](double t) { return 0.5 - 2.0 * std::cos(20.0 * M_PI * t); }, bent, 0.003));
  EXPECT_LT(probability(d, "hysteresis"), 0.5) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
