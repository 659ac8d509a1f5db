#include <limits>
#include <numbers>

#include "hil/diagnose/raw/hum_claim.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

TEST(RawHealth, FindsSpikesAndHeldSamplesWhileTheForceMoves) {
  Campaign c = make_campaign(21, straight);
  auto& U = c.records[3].trace.find("U")->value;
  for (std::size_t i = 500; i < 20000; i += 700) U[i] += 2.0;
  for (std::size_t i = 900; i < 20000; i += 1500)
    for (std::size_t k = 1; k < 20; ++k) U[i + k] = U[i];
  const RecordHealth h = check_raw_health(c.records[3], health_scales(c), c.bench);
  EXPECT_NEAR(static_cast<double>(h.outliers), 28.0, 8.0);
  EXPECT_GT(h.held, 150u);
  const RecordHealth clean = check_raw_health(c.records[0], health_scales(c), c.bench);
  EXPECT_EQ(clean.outliers, 0u);
  EXPECT_EQ(clean.held, 0u);
}

TEST(RawHealth, ALateOutputIsNotTakenForHeldSamples) {
  Campaign c = make_campaign(25, straight, 0.0);
  for (Record& r : c.records) {
    auto& F = r.trace.find("F_ref")->value;
    auto& U = r.trace.find("U")->value;
    constexpr std::size_t kLate = 12;  // samples
    for (std::size_t i = 0; i < F.size(); ++i) {
      // edges of 40 ms every second
      const double x = std::fmod(static_cast<double>(i), 400.0);
      F[i] = 1.0 + 2.0 * std::clamp(x / 8.0, 0.0, 1.0) - 2.0 * std::clamp((x - 200.0) / 8.0, 0.0, 1.0);
      const double y = std::fmod(static_cast<double>(i) + 400.0 - static_cast<double>(kLate), 400.0);
      U[i] = 0.2 + 2.0 * (1.0 + 2.0 * std::clamp(y / 8.0, 0.0, 1.0) -
                          2.0 * std::clamp((y - 200.0) / 8.0, 0.0, 1.0));
    }
    const RecordHealth h = check_raw_health(r, health_scales(c), c.bench);
    EXPECT_EQ(h.held, 0u) << r.name;
  }
}

// Six samples of `size_V` in the first `records` of some short ones.
bool tells_of_outliers(double size_V, std::size_t records) {
  constexpr std::size_t kShort = 2500, kSpikes = 6;
  Campaign c = make_campaign(27, straight);
  for (Record& r : c.records) {
    r.trace.time_bases[0].t_s.resize(kShort);
    for (Channel& channel : r.trace.channels) channel.value.resize(kShort);
  }
  for (std::size_t k = 0; k < kSpikes; ++k) c.records[k % records].trace.find("U")->value[700 + 211 * k] += k % 2 == 0 ? size_V : -size_V;
  return std::ranges::any_of(claims_of_samples(c), [](const HealthClaim& claim) { return claim.effect == "outliers"; });
}

TEST(RawHealth, AFewSpikesAreOutliersWhereTheyMakeMostOfTheError) {
  EXPECT_TRUE(tells_of_outliers(5.0, 3));
  EXPECT_FALSE(tells_of_outliers(1.0, 3)) << "too small to matter";
  EXPECT_FALSE(tells_of_outliers(5.0, 2)) << "somebody touched the cable twice";
}

TEST(RawHealth, TheEndOfAHoldIsNoSpike) {
  Campaign c = make_campaign(26, straight);
  auto& U = c.records[3].trace.find("U")->value;
  for (std::size_t i = 900; i + 40 < U.size(); i += 700)
    for (std::size_t k = 1; k < 30; ++k) U[i + k] = U[i];
  const RecordHealth h = check_raw_health(c.records[3], health_scales(c), c.bench);
  EXPECT_GT(h.held, 300u);
  EXPECT_EQ(h.outliers, 0u);
}

// Below F0 the circuit would be negative, above 4.2 N beyond full scale: the converter shows its ends.
std::vector<double> wider_than_the_range(const std::vector<double>&, const std::vector<double>& F, int) {
  std::vector<double> U;
  for (double f : F) U.push_back(2.6 * f - 1.0);
  return U;
}

TEST(RawHealth, DeclaredEndsOfTheRangeAreNoFinding) {
  const Campaign c = make_campaign(22, wider_than_the_range);
  std::size_t censored = 0;
  for (const Record& r : c.records) {
    const RecordHealth h = check_raw_health(r, health_scales(c), c.bench);
    EXPECT_EQ(h.zeros, 0u) << r.name;
    EXPECT_EQ(h.at_rail, 0u) << r.name;
    EXPECT_EQ(h.held, 0u) << r.name;
    censored += static_cast<std::size_t>(std::ranges::count(h.bad, static_cast<std::uint8_t>(BadSample::censored)));
  }
  EXPECT_GT(censored, 1000u);
  for (std::uint64_t seed = 22; seed <= 24; ++seed) {
    const Diagnosis d = answer(make_campaign(seed, wider_than_the_range));
    EXPECT_EQ(d.verdict, DiagnosisVerdict::none)
        << seed << ": " << (d.findings.empty() ? "" : d.findings.front().effect);
  }
}

TEST(RawHealth, ClaimsAreInTheUnitOfTheOutput) {
  Campaign c = make_campaign(39, straight);
  for (Record& r : c.records) {
    Channel& U = *r.trace.find("U");
    U.unit = "S";
    for (std::size_t i = 0; i < U.value.size(); ++i) U.value[i] += 0.2 * std::sin(2.0 * std::numbers::pi * 50.0 * static_cast<double>(i) / 200.0 + 0.5);
  }
  const std::vector<HealthClaim> claims = claims_of_samples(c);
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "hum");
  EXPECT_EQ(claims[0].unit, "S");
}

TEST(RawHealth, NoiseThatGrowsWithTheLoadIsNoSpike) {
  Campaign c = make_campaign(37, straight);
  Rng rng(37, "load noise");
  for (Record& r : c.records) {
    const auto& F = r.trace.find("F_ref")->value;
    auto& U = r.trace.find("U")->value;
    for (std::size_t i = 0; i < U.size(); ++i) U[i] += 0.08 * std::pow(F[i] / 4.0, 4) * rng.normal();
  }
  for (const HealthClaim& claim : claims_of_samples(c)) EXPECT_NE(claim.effect, "outliers") << claim.evidence;
}

TEST(RawHealth, APeakThatItsNeighboursClimbToIsNoSpike) {
  Campaign c = make_campaign(27, straight);
  auto& U = c.records[3].trace.find("U")->value;
  constexpr double kPeak[] = {0.1, 0.35, 0.7, 0.35, 0.1};
  for (std::size_t i = 500; i + 10 < U.size(); i += 700)
    for (std::size_t k = 0; k < 5; ++k) U[i + k] += kPeak[k];
  EXPECT_EQ(check_raw_health(c.records[3], health_scales(c), c.bench).outliers, 0u);
}

TEST(RawHealth, MainsAtHalfTheRateIsHum) {
  Campaign c = make_campaign(28, straight);
  for (Record& r : c.records) {
    auto& clock = r.trace.time_bases[0].t_s;
    auto& U = r.trace.find("U")->value;
    for (std::size_t i = 0; i < clock.size(); ++i) {
      clock[i] *= 2.0;  // 100 Hz
      U[i] += i % 2 == 0 ? 0.05 : -0.05;
    }
  }
  const std::vector<HealthClaim> claims = claims_of_samples(c);
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "hum");
  EXPECT_NEAR(claims[0].value, 0.05, 0.005);
}

TEST(RawHealth, AReferenceInStepsFarAboveTheDeclaredOnesIsNoisy) {
  Campaign c = make_campaign(29, straight);
  EXPECT_TRUE(claims_of_samples(c).empty());
  for (Record& r : c.records)
    for (double& F : r.trace.find("F_ref")->value) F = 0.3 * std::round(F / 0.3);
  const std::vector<HealthClaim> coarse = claims_of_samples(c);
  ASSERT_EQ(coarse.size(), 1u);
  EXPECT_EQ(coarse[0].effect, "reference_noise");
  EXPECT_NEAR(coarse[0].value, 0.3 / std::sqrt(12.0), 0.02);
}

TEST(RawHealth, MainsOfThirtySamplesASecondIsHumTenTimesASecond) {
  Campaign c = make_campaign(29, straight);
  for (Record& r : c.records) {
    auto& clock = r.trace.time_bases[0].t_s;
    auto& U = r.trace.find("U")->value;
    for (std::size_t i = 0; i < clock.size(); ++i) {
      clock[i] = std::round(1e4 * static_cast<double>(i) / 30.0) * 1e-4;
      U[i] += 0.05 * std::sin(2.0 * std::numbers::pi * 50.0 * static_cast<double>(i) / 30.0);
    }
  }
  const std::vector<HealthClaim> claims = claims_of_samples(c);
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "hum");
  EXPECT_NEAR(claims[0].value, 0.05, 0.005);
}

TEST(RawHealth, AGapInTheClockDoesNotMoveTheMains) {
  Campaign c = make_campaign(30, straight);
  for (Record& r : c.records) {
    auto& clock = r.trace.time_bases[0].t_s;
    auto& U = r.trace.find("U")->value;
    for (std::size_t i = 0; i < clock.size(); ++i) {
      clock[i] += i > clock.size() / 2 ? 4.0 : 0.0;
      U[i] += 0.05 * std::sin(2.0 * std::numbers::pi * 50.0 * clock[i]);
    }
  }
  const RecordHealth h = check_raw_health(c.records[0], health_scales(c), c.bench);
  EXPECT_TRUE(shows_hum(h, health_scales(c)));
  EXPECT_NEAR(h.hum_V, 0.05, 0.005);
}

TEST(RawHealth, AForceThatMovesFastInMostRecordsIsNoNoiseOfTheReference) {
  Campaign c = make_campaign(31, straight);
  c.bench.reference_resolution_N = 0.005;
  c.bench.reference_noise_N = 0.008;
  for (std::size_t k = 0; k < 5; ++k) {
    auto& F = c.records[k].trace.find("F_ref")->value;
    auto& U = c.records[k].trace.find("U")->value;
    const double late_s = 0.03;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double t = c.records[k].trace.time_bases[0].t_s[i], w = 2.0 * std::numbers::pi * 4.0;
      F[i] += 0.3 * std::sin(w * t);
      U[i] += 0.6 * std::sin(w * (t - late_s));
    }
  }
  for (const HealthClaim& claim : claims_of_samples(c)) EXPECT_NE(claim.effect, "reference_noise") << claim.evidence;
}

TEST(RawHealth, AJitteringClockMakesNoNoiseOfAMovingForce) {
  Campaign c = make_campaign(41, straight);
  Rng rng(42, "clock");
  for (Record& r : c.records) {
    auto& t = r.trace.time_bases[0].t_s;
    auto& F = r.trace.find("F_ref")->value;
    for (std::size_t i = 0; i < t.size(); ++i) {
      t[i] = 0.05 * static_cast<double>(i) + 0.003 * rng.normal();
      F[i] = 2.0 + 1.5 * std::sin(2.0 * std::numbers::pi * 1.0 * t[i]) + 0.002 * rng.normal();
    }
  }
  const RecordHealth h = check_raw_health(c.records[0], health_scales(c), c.bench);
  EXPECT_NEAR(h.noise_F_N, 0.002, 0.0008);
}

TEST(RawHealth, ARailIsNoNoiseOfTheReference) {
  Campaign c = make_campaign(43, straight);
  c.bench.reference_resolution_N = 0.005;
  c.bench.reference_noise_N = 0.008;
  for (Record& r : c.records) {
    auto& U = r.trace.find("U")->value;
    for (double& u : U) u = std::min(u, 2.0);
  }
  for (const HealthClaim& claim : claims_of_samples(c)) EXPECT_NE(claim.effect, "reference_noise") << claim.evidence;
}

TEST(RawHealth, AReferenceNoisierThanDeclaredIsSeenWhereTheOutputStandsStill) {
  const auto with_noise = [](double noise_N) {
    Campaign c = make_campaign(33, straight);
    c.bench.reference_noise_N = 0.006;
    Rng rng(34, "reference");
    for (Record& r : c.records) {
      double slow = 0.0;  // 20 ms long, in bursts that fill half the time
      auto& F = r.trace.find("F_ref")->value;
      for (std::size_t i = 0; i < F.size(); ++i) {
        slow = 0.78 * slow + std::sqrt(1.0 - 0.78 * 0.78) * rng.normal();
        F[i] += i % 60 < 30 ? noise_N * slow : 0.0;
      }
    }
    return claims_of_samples(c);
  };
  EXPECT_TRUE(with_noise(0.0).empty());
  EXPECT_TRUE(with_noise(0.006).empty());
  const std::vector<HealthClaim> noisy = with_noise(0.03);
  ASSERT_EQ(noisy.size(), 1u);
  EXPECT_EQ(noisy[0].effect, "reference_noise");
  EXPECT_NEAR(noisy[0].value, std::hypot(0.0094, 0.03 * std::sqrt(0.5)), 0.004);
}

TEST(RawHealth, AReferenceFarNoisierThanTheSensorIsListedWhereNothingIsDeclared) {
  const auto with_noise = [](double noise_N) {
    Campaign c = make_campaign(35, straight);
    c.bench.reference_resolution_N = c.bench.reference_noise_N = kMissing;
    Rng rng(36, "reference");
    for (Record& r : c.records)
      for (double& F : r.trace.find("F_ref")->value) F += noise_N * rng.normal();
    return claims_of_samples(c);
  };
  EXPECT_TRUE(with_noise(0.01).empty());
  const std::vector<HealthClaim> noisy = with_noise(0.08);
  ASSERT_EQ(noisy.size(), 1u);
  EXPECT_EQ(noisy[0].effect, "reference_noise");
  EXPECT_LT(noisy[0].probability, kClaim);
  EXPECT_NEAR(noisy[0].value, 0.08, 0.01);
}

// Noise behind the limit breaks the flat top into short runs, and they are no held samples.
TEST(RawHealth, AnOutputThatStopsBelowItsNoiseHoldsNoSamples) {
  Campaign c = make_campaign(44, straight);
  Rng rng(45, "output");
  for (Record& r : c.records) {
    const std::vector<double>& t = r.trace.time_bases.front().t_s;
    std::vector<double>&F = r.trace.find("F_ref")->value, &U = r.trace.find("U")->value;
    for (std::size_t i = 0; i < F.size(); ++i) {
      F[i] = 2.5 + 2.0 * std::sin(20.0 * t[i]);
      U[i] = std::round((std::min(2.0 * F[i] + 0.2, 7.5011) + 0.0007 * rng.normal()) / 10.0 * 4096.0) / 4096.0 * 10.0;
    }
  }
  for (const HealthClaim& claim : claims_of_samples(c)) EXPECT_NE(claim.effect, "dropouts") << claim.evidence;
}

// Weights put on by hand, one more each time: the step of the force is no error of its reading. A coarse reading of a force that moves is.
TEST(RawHealth, LevelsThatAreSetAreNoStepsOfTheReference) {
  for (const bool read : {false, true}) {
    Campaign c = make_campaign(84, straight);
    c.records.resize(3);
    for (Record& r : c.records) {
      Rng rng(84, r.name);
      TimeBase clock;
      std::vector<double> F, U;
      for (int i = 0; i < 24; ++i) {
        const double up = i < 12 ? i : 23 - i, force = up + (read ? 0.4 * rng.normal() : 0.0);
        clock.t_s.push_back(30.0 * i);
        F.push_back(std::round(force));
        U.push_back(0.2 + 0.3 * force + (i < 12 ? 0.0 : 0.13 * std::sin(std::numbers::pi * up / 11.0)) + 0.003 * rng.normal());
      }
      r.trace.time_bases[0] = clock;
      r.trace.channels = {{"F_ref", "N", "force", 0, F, {}}, {"U", "V", "voltage", 0, U, {}}};
    }
    const HealthScales scales = health_scales(c);
    EXPECT_NEAR(scales.step_N, 1.0, 1e-9);
    for (const Record& r : c.records) EXPECT_NEAR(check_raw_health(r, scales, c.bench).lsb_F_N, read ? 1.0 : 0.0, 1e-9) << r.name;
    if (read) continue;
    const Diagnosis d = answer(std::move(c));
    EXPECT_LT(d.floor, 0.02) << told(d);
    EXPECT_NE(d.verdict, DiagnosisVerdict::none) << told(d);
  }
}

}  // namespace
}  // namespace forcegate::diagnose
