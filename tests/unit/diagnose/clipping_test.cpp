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

TEST(Clipping, IsToldByTheVoltageOfTheRail) {
  const auto rail_of = [](double corner_V) {
    const Diagnosis d = answer(behind(75, 0.04, [=](double u) {
      return corner_V > 0.0 ? 7.0 - corner_V * std::log1p(std::exp((7.0 - u) / corner_V)) : std::min(u, 7.0);
    }));
    const auto f = std::ranges::find(d.findings, "clipping", &Finding::effect);
    EXPECT_NE(f, d.findings.end()) << told(d);
    if (f == d.findings.end() || f->parameters.empty()) return FoundParameter{};
    EXPECT_EQ(f->parameters.front().name, "rail_V") << told(d);
    return f->parameters.front();
  };
  const FoundParameter hard = rail_of(0.0), soft = rail_of(0.16);
  EXPECT_NEAR(hard.value, 7.0, 0.01);
  EXPECT_LT(hard.u, 0.01);
  EXPECT_NEAR(soft.value, 7.0, 2.0 * soft.u + 0.02) << soft.u;
  EXPECT_GT(soft.u, 2.0 * hard.u) << "a round corner has no sharp voltage";
}

}  // namespace
}  // namespace forcegate::diagnose
