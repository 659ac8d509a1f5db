#include <algorithm>
#include <numbers>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

bool tells_of_noise(const Diagnosis& d) {
  return std::any_of(d.notes.begin(), d.notes.end(), [](const std::string& n) { return n.find("noise of the output hangs together") != std::string::npos; });
}

// Noise with a memory of half a second; `size` scales it sample by sample.
using Size = std::function<double(double rate_N_per_s)>;
Campaign with_wander(std::uint64_t seed, double sd_V, const Size& size) {
  int record = 0;
  return make_campaign(seed, [&](const std::vector<double>& t, const std::vector<double>& F, int) {
    Rng rng(seed + static_cast<std::uint64_t>(++record), "wander");
    std::vector<double> U;
    double z = 0.0;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double dt = i == 0 ? 0.005 : t[i] - t[i - 1], keep = std::exp(-dt / 0.5);
      z = keep * z + std::sqrt(1.0 - keep * keep) * rng.normal();
      const double rate = i == 0 ? 0.0 : (F[i] - F[i - 1]) / dt;
      U.push_back(2.0 * F[i] + 0.2 + sd_V * size(rate) * z);
    }
    return U;
  });
}

TEST(ColouredNoise, OfOneSizeInEveryRecordIsNoEffectAndIsTold) {
  for (std::uint64_t seed = 51; seed <= 53; ++seed) {
    const Diagnosis d = answer(with_wander(seed, 0.03, [](double) { return 1.0; }));
    EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << seed;
    EXPECT_TRUE(tells_of_noise(d)) << seed;
  }
}

TEST(ColouredNoise, ThatGrowsWithTheSpeedOfTheLoadIsStructure) {
  const Diagnosis d = answer(with_wander(51, 0.05, [](double rate) { return std::min(2.0, std::abs(rate)); }));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown);
  EXPECT_FALSE(tells_of_noise(d));
}

TEST(ColouredNoise, OfATelegraphIsStructure) {
  int record = 0;
  const Diagnosis d = answer(make_campaign(54, [&](const std::vector<double>&, const std::vector<double>& F, int) {
    Rng rng(static_cast<std::uint64_t>(++record), "telegraph");
    std::vector<double> U;
    double level = 0.03;
    for (const double f : F) {
      if (rng.uniform() < 1.0 / 1000.0) level = -level;
      U.push_back(2.0 * f + 0.2 + level);
    }
    return U;
  }));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown);
}

// Near 5.4 Hz, a little higher towards the end of a record: of one size in every record as noise is, yet at one frequency.
TEST(ColouredNoise, AToneIsStructure) {
  int record = 0;
  const Diagnosis d = answer(make_campaign(55, [&](const std::vector<double>& t, const std::vector<double>& F, int) {
    Rng rng(static_cast<std::uint64_t>(++record), "tone");
    const double start = rng.uniform(0.0, 6.28);
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double turns = 5.37 * t[i] + 0.4 * t[i] * t[i] / 120.0;
      U.push_back(2.0 * F[i] + 0.2 + 0.026 * std::numbers::sqrt2 * std::sin(start + 2.0 * std::numbers::pi * turns));
    }
    return U;
  }));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
  EXPECT_EQ(d.depends_on, std::vector<std::string>{"time"}) << told(d);
  EXPECT_FALSE(tells_of_noise(d)) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
