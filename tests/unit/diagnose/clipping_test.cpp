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

// No noise behind the amplifier: at the rail all samples are one code.
Campaign stopped(std::uint64_t seed, double corner_V) {
  Campaign c = make_campaign(seed, straight, 0.004);
  for (Record& r : c.records)
    for (double& u : r.trace.find("U")->value)
      u = std::round((corner_V > 0.0 ? 7.0 - corner_V * std::log1p(std::exp((7.0 - u) / corner_V)) : std::min(u, 7.0)) * 409.6) / 409.6;
  return c;
}

TEST(Clipping, OfAnAmplifierThatRoundsBeforeItStopsIsNoCurveBeside) {
  for (std::uint64_t seed = 81; seed <= 83; ++seed) {
    const Diagnosis d = answer(stopped(seed, 0.08));
    EXPECT_GE(probability(d, "clipping"), 0.9) << told(d);
    EXPECT_LT(probability(d, "static_nonlinearity"), 0.5) << told(d);
  }
}

TEST(Clipping, IsSeenBelowSpikesThatGoBeyondTheRail) {
  Campaign c = stopped(84, 0.0);
  Rng rng(84, "spikes");
  for (Record& r : c.records)
    for (int k = 0; k < 6; ++k) r.trace.find("U")->value[static_cast<std::size_t>(23000.0 * rng.uniform()) + 500] = 8.2 + 1.5 * rng.uniform();
  const Diagnosis d = answer(std::move(c));
  EXPECT_GE(probability(d, "clipping"), 0.9) << told(d);
  EXPECT_GE(probability(d, "outliers"), 0.9) << told(d);
  EXPECT_LT(probability(d, "adc_codes"), 0.5) << told(d);
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

// A film that conducts less and less: its output bends over the whole range and goes on rising to its end, where one record is held for long.
TEST(Clipping, IsNoSmoothCurveThatGoesOnRising) {
  Campaign c = make_campaign(76, straight);
  c.bench = BenchFacts{};
  c.records.resize(3);
  for (std::size_t k = 0; k < c.records.size(); ++k) {
    Rng rng(40 + k, "presses");
    Record& r = c.records[k];
    r.kind.clear();
    r.role = RecordRole::fit;
    auto& F = r.trace.find("F_ref")->value;
    auto& U = r.trace.find("U")->value;
    double first = std::max(0.9, std::abs(rng.normal())) + 0.08, second = first;  // a load that is let go
    for (std::size_t i = 0; i < F.size(); ++i) {
      first += 0.01 * (std::abs(rng.normal()) - first);
      second += 0.01 * (first - second);
      double force = std::clamp((k == 0 ? 1.0 : 0.5) * (12.0 * second - 9.0), 0.0, 11.0);
      if (k == 2) force = i < 4000 || i > 18000 ? 0.6 : 11.0;
      F[i] = force + 0.03 * rng.normal();
      U[i] = 0.1 + 4.0 * (1.0 - std::exp(-force / 6.0)) + 0.003 * rng.normal();
    }
  }
  const Diagnosis d = answer(std::move(c));
  EXPECT_LT(probability(d, "clipping"), 0.5) << told(d);
  EXPECT_NE(d.verdict, DiagnosisVerdict::none) << told(d);
}

// The curve is several times as large as what the rail takes, and a bent form leaves something along any corner.
TEST(Clipping, StandsBesideACurveWhereTheOutputStandsStill) {
  const double gain_V = 8.0 / std::pow(4.4, 0.85);
  for (std::uint64_t seed = 77; seed <= 79; ++seed) {
    const Diagnosis d = answer(behind(seed, 0.015, [=](double u) { return std::min(0.2 + gain_V * std::pow(std::max(0.0, u - 0.2) / 2.0, 0.85), 7.44); }));
    EXPECT_GE(probability(d, "clipping"), 0.9) << told(d);
    EXPECT_GE(probability(d, "static_nonlinearity"), 0.9) << told(d);
    EXPECT_NE(told(d).find("above it the output stands still"), std::string::npos) << told(d);
  }
}

}  // namespace
}  // namespace forcegate::diagnose
