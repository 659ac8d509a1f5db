// Samples that stand far off their neighbours, and what is none of them.

#include <array>
#include <limits>
#include <numbers>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// Of either sign, cut off at both ends of the range; `keep`: what is left of it a sample later.
Campaign with_tailed_spikes(double keep) {
  Campaign c = make_campaign(46, straight);
  Rng rng(47, "spikes");
  for (Record& r : c.records) {
    auto& U = r.trace.find("U")->value;
    for (std::size_t i = 300; i + 300 < U.size(); i += 700) {
      double spike = rng.normal();
      spike = std::copysign(2.0 + 2.0 * std::abs(spike), spike);
      for (std::size_t k = i; std::abs(spike) > 0.02; ++k, spike *= keep) U[k] = std::clamp(U[k] + spike, 0.0, 10.0);
    }
  }
  return c;
}

TEST(Spikes, ASpikeMayHaveATailOfAFewSamples) {
  const std::vector<HealthClaim> claims = claims_of_samples(with_tailed_spikes(0.15));
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "outliers");
  const Diagnosis d = answer(with_tailed_spikes(0.15));
  EXPECT_FALSE(d.residual_unknown) << told(d);
  for (const HealthClaim& claim : claims_of_samples(with_tailed_spikes(0.9))) EXPECT_NE(claim.effect, "outliers") << "a film that slips and creeps back is no spike";
}

// A discharge behind a filter that forgets half of it within a sample: 3 % of the span, eight in a record.
TEST(Spikes, OnesWithTheCourseOfAFilterMayBeSmall) {
  Campaign c = make_campaign(50, straight);
  for (Record& r : c.records) {
    auto& U = r.trace.find("U")->value;
    for (std::size_t n = 0; n < 8; ++n) {
      double spike = n % 3 == 0 ? -0.22 : 0.25;
      for (std::size_t k = 1200 + 2710 * n; std::abs(spike) > 1e-3; ++k, spike *= 0.55) U[k] = std::clamp(U[k] + spike, 0.0, 10.0);
    }
  }
  const std::vector<HealthClaim> claims = claims_of_samples(c);
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "outliers");
}

// A cable that rings at 23 Hz behind each step of a load: half a turn is four samples.
TEST(Spikes, WhatRingsBehindAnEdgeThrowsNothing) {
  Campaign c = make_campaign(51, straight);
  for (Record& r : c.records) {
    const auto& t = r.trace.time_bases.front().t_s;
    auto &F = r.trace.find("F_ref")->value, &U = r.trace.find("U")->value;
    for (std::size_t i = 0; i < U.size(); ++i) {
      const double since = std::fmod(t[i], 6.0), step = std::fmod(t[i], 12.0) < 6.0 ? 3.0 : 1.0;
      F[i] = step + (step > 2.0 ? -2.0 : 2.0) * std::exp(-since / 0.02) + 0.002 * std::sin(37.0 * t[i]);
      U[i] = 2.0 * F[i] + 0.2 + 1.5 * std::exp(-since / 0.2) * std::sin(2.0 * std::numbers::pi * 23.0 * since) + 0.004 * std::sin(1.0e5 * t[i]);
    }
  }
  for (const HealthClaim& claim : claims_of_samples(c)) EXPECT_NE(claim.effect, "outliers") << claim.evidence;
}

// A contact that fails throws two to four samples up and down, a few times in each record.
TEST(Spikes, AFewSamplesUpAndDownAreOneSpike) {
  Campaign c = make_campaign(48, straight);
  std::size_t thrown = 0;
  for (Record& r : c.records) {
    auto& U = r.trace.find("U")->value;
    for (const std::size_t i : {5003u, 11207u, 17831u}) {
      for (const double off_V : {0.9, -0.6, -0.4, 0.5}) U[i + thrown++ % 4] += off_V;
    }
  }
  const std::vector<HealthClaim> claims = claims_of_samples(c);
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "outliers");
  const HealthScales scales = health_scales(c);
  for (const Record& r : c.records) EXPECT_GE(check_raw_health(r, scales, c.bench).outliers, 11u) << r.name;
}

// Blocks of one to three samples, up or down, each by another size: of a few there is one of every kind in each record. What the low end of
// the range cuts off of them is no loss of samples.
TEST(Spikes, BlocksThrownUpAndDownAreSpikesAndNoDropouts) {
  Campaign c = make_campaign(49, straight);
  Rng rng(49, "blocks");
  for (Record& r : c.records) {
    auto& U = r.trace.find("U")->value;
    for (std::size_t at = 1500; at + 1500 < U.size(); at += 2500) {
      const double size_V = (at / 2500 % 2 == 0 ? 1.0 : -1.0) * (0.6 + 2.4 * rng.uniform());
      for (std::size_t k = 0; k < 1 + at / 2500 % 3; ++k) U[at + k] = std::clamp(U[at + k] + size_V, 0.0, 10.0);
    }
  }
  const std::vector<HealthClaim> claims = claims_of_samples(c);
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "outliers");
}

// One burst in a record, up in one and down in the next, whatever course it takes: together the records show what none of them shows alone.
TEST(Spikes, ABurstInEachRecordIsSeenInAllTogether) {
  Campaign c = make_campaign(51, straight);
  Rng rng(51, "bursts");
  bool up = true;
  for (Record& r : c.records) {
    auto& U = r.trace.find("U")->value;
    for (std::size_t k = 0; k < 4; ++k) U[9000 + k] = std::max(0.0, U[9000 + k] + (up ? 1.0 : -1.0) * (1.0 + 2.5 * rng.uniform()));
    up = !up;
  }
  const std::vector<HealthClaim> claims = claims_of_samples(c);
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "outliers");
  const HealthScales scales = health_scales(c);
  for (const Record& r : c.records) {
    const RecordHealth h = check_raw_health(r, scales, c.bench);
    EXPECT_EQ(h.outliers + h.lone_zeros, 4u) << r.name;
  }
}

// A sensor that rings after an edge swings below the end of the converter's range, one period after another.
TEST(Spikes, ASwingThatTheEndOfTheRangeCutsOffIsNoDropout) {
  Campaign c = make_campaign(50, [](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    for (const double f : F) U.push_back(0.3 * f + 0.4);
    return U;
  });
  for (Record& r : c.records) {
    auto& U = r.trace.find("U")->value;
    for (std::size_t at = 2000; at + 400 < U.size(); at += 3000)
      for (std::size_t k = 0; k < 400; ++k) {
        const double t = static_cast<double>(k) / 200.0;
        U[at + k] = std::max(0.0, U[at + k] + 2.5 * std::exp(-4.0 * t) * std::sin(2.0 * std::numbers::pi * 12.3 * t));
      }
  }
  for (const HealthClaim& claim : claims_of_samples(c)) EXPECT_NE(claim.effect, "dropouts") << claim.evidence;
}

// A code that stands for an error is read at any level of the output: its step is another one each time.
TEST(Spikes, SpikesOfOneValueAreNoBit) {
  for (const double value_V : {9.99, -999.0, 1e9}) {
    Campaign c = make_campaign(81, [](const auto&, const auto& F, int) {
      std::vector<double> U;
      for (const double f : F) U.push_back(0.3 * f + 0.2);
      return U;
    });
    c.bench.voltage_min_V = c.bench.voltage_max_V = std::numeric_limits<double>::quiet_NaN();
    for (Record& r : c.records)
      for (std::size_t i = 433; i < 24000; i += 701) r.trace.find("U")->value[i] = value_V;
    const std::vector<HealthClaim> claims = claims_of_samples(c);
    ASSERT_EQ(claims.size(), 1u) << value_V;
    EXPECT_EQ(claims[0].effect, "outliers") << value_V;
  }
}

// Every 800th sample, where a triangle of 4000 samples is always at one of the same five levels.
TEST(Spikes, OneStepAgainAndAgainIsABitWhereverTheForceThenIs) {
  for (const double step_V : {1.25, 10.0}) {
    Campaign c = make_campaign(82, [](const auto&, const auto& F, int) {
      std::vector<double> U;
      for (const double f : F) U.push_back(0.3 * f + 0.2);
      return U;
    });
    for (Record& r : c.records) {
      auto& F = r.trace.find("F_ref")->value;
      auto& U = r.trace.find("U")->value;
      Rng rng(82, r.name);
      for (std::size_t i = 0; i < U.size(); ++i) {
        F[i] = 0.5 + 4.0 * std::abs(1.0 - std::fmod(static_cast<double>(i), 4000.0) / 2000.0);
        U[i] = 0.3 * F[i] + 0.2 + 0.003 * rng.normal() + (i % 800 == 499 ? step_V : 0.0);
      }
    }
    const std::vector<HealthClaim> claims = claims_of_samples(c);
    ASSERT_FALSE(claims.empty()) << step_V;
    EXPECT_EQ(claims[0].effect, step_V < 10.0 ? "adc_codes" : "outliers") << step_V;
  }
}

TEST(Spikes, ANoisyStretchInOnePieceIsNoSpikes) {
  Campaign c = make_campaign(83, straight);
  Rng rng(83, "stretch");
  for (Record& r : c.records) {
    auto& U = r.trace.find("U")->value;
    for (std::size_t i = 9000; i < 12000; ++i) U[i] = std::max(0.0, U[i] + 0.3 * rng.normal());
  }
  for (const HealthClaim& claim : claims_of_samples(c)) EXPECT_NE(claim.effect, "outliers") << claim.evidence;
}

// Noise makes a converter jump up and down between the two sides of a step, wherever one is; the steps differ.
TEST(Spikes, WhatGoesBackAndForthOverStepsOfTheConverterIsNoSpikes) {
  constexpr std::array kStep_V{0.36, -0.28, 0.41, -0.33, 0.3};
  Campaign c = make_campaign(84, straight);
  for (Record& r : c.records) {
    auto& F = r.trace.find("F_ref")->value;
    auto& U = r.trace.find("U")->value;
    Rng rng(84, r.name);
    for (std::size_t i = 0; i < U.size(); ++i) {
      F[i] = 0.2 + 3.8 * std::abs(1.0 - std::fmod(static_cast<double>(i), 1000.0) / 500.0);
      U[i] = 2.0 * F[i] + 0.2 + 0.015 * rng.normal();
      double steps_V = 0.0;
      for (std::size_t k = 0; k < 20; ++k) steps_V += U[i] > 0.9 + 0.35 * static_cast<double>(k) ? kStep_V[k % kStep_V.size()] : 0.0;
      U[i] += steps_V;
    }
  }
  for (const HealthClaim& claim : claims_of_samples(c)) EXPECT_NE(claim.effect, "outliers") << claim.evidence;
}

// A bit goes up where it is clear and down where it is set.
TEST(Spikes, OfOneSizeAndEitherSignAreABitWhereTheSignGoesWithTheLevel) {
  for (const bool of_bit : {true, false}) {
    Campaign c = make_campaign(83, straight);
    c.bench.voltage_min_V = c.bench.voltage_max_V = std::numeric_limits<double>::quiet_NaN();
    Rng rng(83, "sign");
    for (Record& r : c.records) {
      auto& U = r.trace.find("U")->value;
      for (std::size_t i = 433; i < U.size(); i += 701) {
        const bool is_set = of_bit ? std::fmod(U[i], 1.6) >= 0.8 : rng.uniform() < 0.5;
        U[i] += is_set ? -0.8 : 0.8;
      }
    }
    const std::vector<HealthClaim> claims = claims_of_samples(c);
    ASSERT_EQ(claims.size(), 1u);
    EXPECT_EQ(claims[0].effect, of_bit ? "adc_codes" : "outliers");
  }
}

}  // namespace
}  // namespace forcegate::diagnose
