#include "hil/diagnose/raw/smoothed_reference.h"

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

constexpr double kRate_Hz = 50.0, kNoise_N = 0.06, kSpan_N = 15.0;

// Footsteps: a steep heel strike, two humps, the foot off the ground.
std::vector<double> walk(Rng& rng, std::size_t n, double hertz) {
  std::vector<double> F;
  double phase = rng.uniform(), stride = 1.0;
  for (std::size_t i = 0; i < n; ++i) {
    phase += stride * hertz / kRate_Hz;
    if (phase >= 1.0) phase -= 1.0, stride = 1.0 + 0.05 * rng.normal();
    const auto hump = [&](double at, double width) { return std::exp(-0.5 * std::pow((phase - at) / width, 2)); };
    F.push_back(1.0 + kSpan_N * (0.9 * hump(0.18, 0.06) + 0.55 * hump(0.32, 0.06) + 0.95 * hump(0.47, 0.055) + 0.2 * hump(0.06, 0.015)));
  }
  return F;
}

std::vector<double> with_noise(std::vector<double> F, Rng& rng, double sd_N) {
  for (double& f : F) f += sd_N * rng.normal();
  return F;
}

SharedPart shared(const std::vector<double>& recorded, const std::vector<double>& smoothed, const std::vector<double>& U) {
  return shared_with_output(recorded, smoothed, U, std::vector<std::uint8_t>(U.size(), 0));
}

TEST(SmoothedReference, NoiseMovesTheReferenceAloneAndAForceMovesTheOutputToo) {
  Rng rng(3, "walk");
  const std::vector<double> F = walk(rng, 4000, 0.9), recorded = with_noise(F, rng, kNoise_N);
  std::vector<double> U;
  for (const double f : F) U.push_back(0.16 * f - 0.1 + 0.002 * rng.normal());
  const SharedPart noise = shared(recorded, F, U);
  EXPECT_NEAR(noise.share, 0.0, 4.0 * noise.standard_error);
  EXPECT_LT(noise.standard_error, 0.05);

  std::vector<double> flattened = F;
  for (std::size_t i = 4; i + 4 < F.size(); ++i) {
    flattened[i] = 0.0;
    for (std::size_t k = i - 4; k <= i + 4; ++k) flattened[i] += F[k] / 9.0;
  }
  const SharedPart force = shared(F, flattened, U);
  EXPECT_NEAR(force.share, 1.0, 0.12) << "what is taken is large here: the gains of the stretches lean to that of the record";
}

TEST(SmoothedReference, MissingAndBadSamplesHaveNoSay) {
  Rng rng(4, "walk");
  const std::vector<double> F = walk(rng, 1000, 0.9), recorded = with_noise(F, rng, kNoise_N);
  std::vector<double> U;
  for (const double f : F) U.push_back(0.16 * f);
  const double share = shared(recorded, F, U).share;
  std::vector<std::uint8_t> bad(U.size(), 0);
  std::vector<double> broken = U;
  for (std::size_t i = 10; i < U.size(); i += 97) broken[i] = 9.0, bad[i] = 1;
  EXPECT_NEAR(shared_with_output(recorded, F, broken, bad).share, share, 0.02);
  EXPECT_TRUE(std::isinf(shared({}, {}, {}).standard_error));
  const std::vector<double> nothing(50, kMissing);
  EXPECT_TRUE(std::isinf(shared(nothing, nothing, nothing).standard_error));
}

// What the wide windows flatten is the same in every step, and so no chance: neither a curve nor a loop of the sensor.
TEST(SmoothedReference, AnInsoleThatWalksIsNoCurveThoughItsReferenceIsNoisy) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Rng rng(seed, "insole");
    Campaign c;
    c.name = "insole";
    c.bench.reference_noise_N = kNoise_N;
    c.bench.reference_resolution_N = 0.01;
    for (int k = 0; k < 7; ++k) {
      Record r;
      r.name = "walk" + std::to_string(k);
      r.start_s = 400.0 * k;
      r.dynamic = false;
      TimeBase clock;
      const std::vector<double> F = walk(rng, 3000, 0.75 + 0.05 * k);
      std::vector<double> U;
      for (std::size_t i = 0; i < F.size(); ++i) {
        clock.t_s.push_back(static_cast<double>(i) / kRate_Hz);
        U.push_back(0.16 * F[i] + 0.3 + 0.001 * rng.normal());
      }
      r.trace.time_bases.push_back(clock);
      r.trace.channels.push_back({"F_ref", "N", "force", 0, with_noise(F, rng, kNoise_N), {}});
      r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
      c.records.push_back(std::move(r));
    }
    const Diagnosis d = answer(std::move(c));
    EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << seed << told(d);
  }
}

}  // namespace
}  // namespace forcegate::diagnose
