// A reference whose noise is two or three percent of the span bends and delays whatever is regressed on it. Nothing is missing.

#include <numbers>

#include "hil/diagnose/choose/select.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

struct Bench {
  double rate_Hz, noise_N;
  std::function<double(double t, int record)> force;
};

Campaign measured(const Bench& bench, std::uint64_t seed) {
  Campaign c = make_campaign(seed, straight, 0.0);
  Rng rng(seed, "noisy");
  for (std::size_t k = 0; k < c.records.size(); ++k) {
    Trace& trace = c.records[k].trace;
    std::vector<double>&t = trace.time_bases[0].t_s, &F = trace.channels[0].value, &U = trace.channels[1].value;
    t.clear(), F.clear(), U.clear();
    const double gain = 2.0 * (1.0 + 0.003 * rng.normal()), zero = 0.2 + 0.01 * rng.normal();
    for (int i = 0; i < static_cast<int>(90.0 * bench.rate_Hz); ++i) {
      t.push_back(i / bench.rate_Hz);
      const double f = bench.force(t.back(), static_cast<int>(k));
      F.push_back(f + bench.noise_N * rng.normal());
      U.push_back(gain * f + zero + 0.004 * rng.normal());
    }
  }
  c.bench.reference_noise_N = bench.noise_N;
  return c;
}

// Steps on an insole: half of the time there is no load.
double gait(double t, int record) {
  const double phase = std::fmod(t * (0.8 + 0.05 * record), 1.0);
  return phase < 0.55 ? 4.0 * std::sin(std::numbers::pi * phase / 0.55) : 0.0;
}

// Ramps and sines of a slow logger.
double mixed(double t, int record) {
  if (record % 2 == 0) return 0.4 + 3.6 * std::abs(std::fmod(t / 20.0, 2.0) - 1.0);
  return 2.2 + 1.7 * std::sin(2.0 * std::numbers::pi * (0.2 + 0.15 * record) * t);
}

class NoisyReference : public ::testing::TestWithParam<std::pair<Bench, std::uint64_t>> {};

TEST_P(NoisyReference, IsNoEffect) {
  const auto& [bench, seed] = GetParam();
  const Diagnosis d = answer(measured(bench, seed));
  EXPECT_NE(d.verdict, DiagnosisVerdict::known) << told(d);
}

std::vector<std::pair<Bench, std::uint64_t>> benches() {
  std::vector<std::pair<Bench, std::uint64_t>> out;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    out.push_back({{25.0, 0.11, gait}, seed});
    out.push_back({{20.0, 0.13, mixed}, seed});
  }
  return out;
}

INSTANTIATE_TEST_SUITE_P(Benches, NoisyReference, ::testing::ValuesIn(benches()));

// Sixteen codes of a converter would make the forces of a staircase exact, where the two have the same step.
TEST(NoisyReference, OfAStaircaseHasNoCodes) {
  for (const double step_N : {0.31, 0.45, 0.62})
    for (const double noise_N : {0.01, 0.06}) {
      const double stays_s = 45.0 * step_N / 4.3;
      const auto stairs = [=](double t, int) { return 0.4 + step_N * std::floor(std::min(t, 90.0 - t) / stays_s); };
      const Diagnosis d = answer(measured({50.0, noise_N, stairs}, 6));
      EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << step_N << " N, " << noise_N << " N\n" << told(d);
    }
}

// It looks like friction, lag, delay and RC at once; these are turned down one by one, and what the records differ by is asked all the same.
TEST(NoisyReference, HidesNoEffectBetweenRecords) {
  constexpr double kHumidity[] = {50.0, 56.0, 47.0, 53.0, 49.0, 57.0, 54.0, 48.0};
  const auto stairs = [](double t, int record) { return 0.4 + 0.45 * std::floor(std::min(t, 90.0 - t) / (5.0 + 0.3 * record)); };
  Campaign c = measured({20.0, 0.1, stairs}, 5);
  for (std::size_t k = 0; k < c.records.size(); ++k) {
    c.records[k].humidity_pct = kHumidity[k];
    for (double& U : c.records[k].trace.channels[1].value) U *= 1.0 + 0.01 * (kHumidity[k] - 52.0);
  }
  const Diagnosis d = answer(std::move(c));
  EXPECT_GE(std::ranges::count_if(d.refused, [](const RefusedEffect& r) { return !is_between_records(r.effect); }), 4) << told(d);
  EXPECT_GE(probability(d, "humidity"), 0.5) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
