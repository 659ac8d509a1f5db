// The width that is told of a loop, beside what the loop explains.

#include "hil/diagnose/answer/reservation.h"
#include "tests/unit/diagnose/made_campaign.h"

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
  Campaign c;
  c.name = "fast";
  Record r;
  r.name = "fast";
  Rng rng(71, "fast");
  TimeBase clock;
  std::vector<double> F, U;
  for (int i = 0; i < 100000; ++i) {
    const double t = 0.01 * i, f = 0.5 - 2.0 * std::cos(20.0 * M_PI * t);
    clock.t_s.push_back(t);
    F.push_back(f + 0.003 * rng.normal());
    U.push_back(2.0 * f + f * f / 30.0 + 0.5 + 0.003 * rng.normal());
  }
  r.trace.time_bases.push_back(clock);
  r.trace.channels.push_back({"F_ref", "N", "force", 0, F, {}});
  r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
  c.records.push_back(std::move(r));
  const Diagnosis d = answer(std::move(c));
  EXPECT_LT(probability(d, "hysteresis"), 0.5) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
