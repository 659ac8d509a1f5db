// A file of means shows no steps, and has what they leave: the instruments' declared steps tell of it.

#include <algorithm>
#include <cmath>

#include "hil/diagnose/raw/sample_noise.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

constexpr double kStep_N = 0.025, kNoise_N = 0.006, kRate_Hz = 1000.0, kGain_V_per_N = 1.8;

double rounded(double x, double step) { return std::round(x / step) * step; }

// Slow triangles of a straight sensor, sampled at 1 kHz and written as means of `of`.
Campaign means_of(int of, int adc_bits) {
  const double step_V = 10.0 / std::exp2(adc_bits);
  Campaign c;
  c.name = "means";
  c.bench.reference_resolution_N = kStep_N;
  c.bench.reference_noise_N = kNoise_N;
  c.bench.voltage_min_V = 0.0;
  c.bench.voltage_max_V = 10.0;
  c.bench.adc_bits = adc_bits;
  for (int k = 0; k < 3; ++k) {
    Rng rng(static_cast<std::uint64_t>(k + 1), "means");
    Record r;
    r.name = "triangles" + std::to_string(k);
    r.kind = "ramp";
    r.start_s = 1000.0 * k;
    TimeBase clock;
    std::vector<double> F, U;
    for (int row = 0; row < static_cast<int>(100.0 * kRate_Hz) / of; ++row) {
      double F_sum = 0.0, U_sum = 0.0, t_sum = 0.0;
      for (int i = 0; i < of; ++i) {
        const double t = (row * of + i) / kRate_Hz, x = std::fmod(t / 50.0, 1.0), f = 0.3 + 3.7 * (x < 0.5 ? 2.0 * x : 2.0 - 2.0 * x);
        t_sum += t;
        F_sum += rounded(f + kNoise_N * rng.normal(), kStep_N);
        U_sum += rounded(kGain_V_per_N * f + 0.1 + 0.001 * rng.normal(), step_V);
      }
      clock.t_s.push_back(t_sum / of);
      F.push_back(F_sum / of);
      U.push_back(U_sum / of);
    }
    r.trace.time_bases.push_back(clock);
    r.trace.channels.push_back({"F_ref", "N", "force", 0, F, {}});
    r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
    c.records.push_back(std::move(r));
  }
  return c;
}

TEST(AveragedFile, HasTheFloorOfItsDeclaredSteps) {
  EXPECT_EQ(answer(means_of(20, 16)).verdict, DiagnosisVerdict::none);
  EngineOptions options;
  options.threads = 1;
  const auto w = prepare(means_of(20, 16), options);
  ASSERT_TRUE(w) << w.error().to_text();
  const double left_V = kGain_V_per_N * left_of_dithered_step(kStep_N, kNoise_N);
  for (const double noise_V : (*w)->noise_V) {
    EXPECT_GT(noise_V, left_V);
    EXPECT_LT(noise_V, 2.0 * left_V);
  }
}

// Rounding of a steady ramp is a saw-tooth, 7 steps a second here: a line that the force does not have.
TEST(AveragedFile, StepsOfADeclaredConverterAreNoLine) {
  const Diagnosis d = answer(means_of(5, 8));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_NEAR(d.floor, 10.0 / 256.0 / std::sqrt(12.0), 2e-3);
}

}  // namespace
}  // namespace forcegate::diagnose
