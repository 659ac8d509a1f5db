// A rail stops the output at one voltage. Where the gain differs from record to record each meets it at a force of its own, and where the
// converter's noise comes behind the amplifier no two samples at the rail are alike.

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// Records of different gain, then what `amplifier` makes of the output, then the converter.
Campaign behind(std::uint64_t seed, double gain_scatter, const std::function<double(double)>& amplifier) {
  Campaign c = make_campaign(seed, straight, 0.0);
  Rng rng(seed, "amplifier");
  for (Record& r : c.records) {
    const double gain = 1.0 + gain_scatter * rng.normal();
    for (double& u : r.trace.find("U")->value) u = std::round((amplifier(gain * u) + 0.004 * rng.normal()) * 409.6) / 409.6;
  }
  return c;
}

TEST(Clipping, IsToldFromACurveThoughTheGainDiffersFromRecordToRecord) {
  for (std::uint64_t seed = 71; seed <= 74; ++seed) {
    const Diagnosis d = answer(behind(seed, 0.04, [](double u) { return std::min(u, 7.0); }));
    EXPECT_GE(probability(d, "clipping"), 0.9) << told(d);
    EXPECT_LT(probability(d, "static_nonlinearity"), 0.5) << told(d);
  }
}

}  // namespace
}  // namespace forcegate::diagnose
