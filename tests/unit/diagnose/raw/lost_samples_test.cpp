#include <algorithm>
#include <cmath>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

TEST(LostSamples, AFallToZeroThatTheForceDoesNotExplainIsLostSamples) {
  Campaign c = make_campaign(23, straight);
  auto& U = c.records[3].trace.find("U")->value;
  for (std::size_t i = 400; i + 20 < U.size(); i += 500)
    for (std::size_t k = 0; k < 12; ++k) U[i + k] = 0.0;
  EXPECT_GT(check_raw_health(c.records[3], health_scales(c), c.bench).zeros, 100u);
}

enum class Holds { until_it_moves_by_a_step, for_a_time };

// A load of many speeds, and a link that holds the output.
Campaign held_by_link(Holds how) {
  constexpr double kStep_V = 0.25;
  Campaign c = make_campaign(43, straight);
  for (const std::size_t k : {0u, 3u, 4u, 7u}) {
    const std::vector<double>& t_s = c.records[k].trace.time_bases[0].t_s;
    auto &F = c.records[k].trace.find("F_ref")->value, &U = c.records[k].trace.find("U")->value;
    double sent_V = -1.0;
    for (std::size_t i = 0; i < U.size(); ++i) {
      F[i] = 2.2 + 1.9 * std::sin(6.0 * t_s[i]) * std::sin(0.07 * t_s[i]);
      const double now_V = 2.0 * F[i] + 0.2;
      if (how == Holds::for_a_time ? i % 300 < 2 || i % 300 > 40 : std::abs(now_V - sent_V) >= kStep_V) sent_V = now_V;
      U[i] = sent_V;
    }
  }
  return c;
}

// Nothing is lost between two values that a logger sends because they differ by a step: each stands for as long as the force needs for one.
TEST(LostSamples, ALoggerThatSendsChangesOnlyLosesNone) {
  const auto says_lost = [](const Campaign& c) {
    return std::ranges::any_of(claims_of_samples(c), [](const HealthClaim& claim) { return claim.effect == "dropouts"; });
  };
  const Campaign logger = held_by_link(Holds::until_it_moves_by_a_step);
  EXPECT_GT(check_raw_health(logger.records[0], health_scales(logger), logger.bench).runs.size(), 20u) << "they are seen";
  EXPECT_FALSE(says_lost(logger));
  const Diagnosis d = answer(logger);
  EXPECT_NE(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_TRUE(std::ranges::any_of(d.follows, [](const std::string& what) { return what.find("only when it has moved") != std::string::npos; })) << told(d);
  EXPECT_TRUE(says_lost(held_by_link(Holds::for_a_time)));
}

TEST(LostSamples, ALostSampleOfTheReferenceHidesNoHeldOutput) {
  const auto held = [](bool one_lost) {
    Campaign c = make_campaign(35, straight);
    for (const std::size_t k : {0u, 3u, 4u}) {
      auto& U = c.records[k].trace.find("U")->value;
      for (std::size_t i = 5000; i < 5300; ++i) U[i] = U[5000];
      if (one_lost) c.records[k].trace.find("F_ref")->value[5100] = kMissing;
      if (one_lost) c.records[k].trace.find("F_ref")->value[5000] = kMissing;
    }
    return claims_of_samples(c);
  };
  for (const bool one_lost : {false, true}) {
    const std::vector<HealthClaim> claims = held(one_lost);
    ASSERT_EQ(claims.size(), 1u) << one_lost;
    EXPECT_EQ(claims[0].effect, "dropouts");
  }
}

TEST(LostSamples, OneRecordThatHoldsAgainAndAgainIsEnoughWhereTheOthersAreSlow) {
  const auto held = [](std::size_t runs) {
    Campaign c = make_campaign(37, straight);
    auto& U = c.records[3].trace.find("U")->value;  // the fast ramps
    for (std::size_t j = 0; j < runs; ++j)
      for (std::size_t i = 0; i < 40; ++i) U[1007 + 1117 * j + i] = U[1007 + 1117 * j];
    return claims_of_samples(c);
  };
  const std::vector<HealthClaim> claims = held(18);
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "dropouts");
  EXPECT_TRUE(held(5).empty()) << "a hand on the cable";
}

// The highest sample is held as any other is; a rail is met again at the same value.
TEST(LostSamples, HeldAtTheHighestSampleIsNoRail) {
  const auto effects = [](int of_top) {
    Campaign c = make_campaign(35, straight);
    for (const std::size_t k : {0u, 4u, 7u}) {
      auto& held = c.records[k].trace.find("U")->value;
      std::fill_n(held.begin() + 5000, 300, held[5000]);
    }
    auto& U = c.records[3].trace.find("U")->value;  // the fast ramps
    const auto top = std::ranges::max_element(U);
    const double top_V = *top;
    std::fill_n(top, 280, top_V);
    for (int again = 1; again < of_top; ++again) std::fill_n(U.begin() + 450 + 4000 * again, 100, top_V);
    std::vector<std::string> out;
    for (const HealthClaim& claim : claims_of_samples(c)) out.push_back(claim.effect);
    return out;
  };
  EXPECT_EQ(effects(1), (std::vector<std::string>{"dropouts"}));
  EXPECT_EQ(effects(3), (std::vector<std::string>{"dropouts", "clipping"}));
}

// Whatever the force does meanwhile: the noise would have gone on.
TEST(LostSamples, OneCodeForLongIsHeldWhereNoiseGoesOverTheCodes) {
  const auto held = [](std::size_t each) {
    Campaign c = make_campaign(39, straight);
    for (const std::size_t k : {1u, 2u}) {  // a staircase and a hold
      auto& U = c.records[k].trace.find("U")->value;
      for (std::size_t j = 0; j < each; ++j)
        for (std::size_t i = 0; i < 24; ++i) U[4030 + 2400 * j + i] = U[4030 + 2400 * j];
    }
    return claims_of_samples(c);
  };
  EXPECT_TRUE(held(0).empty());
  EXPECT_TRUE(held(1).empty()) << "a hand on the cable";
  const std::vector<HealthClaim> claims = held(3);
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "dropouts");
}

TEST(LostSamples, TwoHoldsThatTheForceLeavesFarBehindAreEnoughInOneRecord) {
  const auto held = [](std::size_t holds) {
    Campaign c = make_campaign(41, [](const std::vector<double>&, const std::vector<double>& F, int) {
      std::vector<double> U;
      for (const double f : F) U.push_back(0.9 * f + 0.2);  // a film that has lost half of its swing
      return U;
    });
    auto& U = c.records[3].trace.find("U")->value;
    for (std::size_t j = 0; j < holds; ++j)  // over a turn of the triangle, and on to where it is no more
      for (std::size_t i = 0; i < 400; ++i) U[2350 + 3000 * j + i] = U[2350 + 3000 * j];
    return claims_of_samples(c);
  };
  EXPECT_TRUE(held(0).empty());
  const std::vector<HealthClaim> claims = held(2);
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "dropouts");
}

// A triangle of 5 s comes back to where it was: ends and halves of what is held there have the same force.
TEST(LostSamples, AHoldOverAWholeCycleIsLostSamplesAndALongOneIsEnough) {
  const auto held = [](std::size_t length) {
    Campaign c = make_campaign(39, straight);
    auto& U = c.records[3].trace.find("U")->value;
    for (std::size_t i = 0; i < length; ++i) U[4000 + i] = U[4000];
    return claims_of_samples(c);
  };
  const std::vector<HealthClaim> claims = held(1000);
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "dropouts");
  EXPECT_TRUE(held(20).empty()) << "a tenth of a second, once";
}

// Of a sine of 3 Hz a hold is let go wherever the force is by then, and the next sample is far again: the noise tells that it was held.
TEST(LostSamples, HoldsOfAFastSineAreFoundWhereverTheyEnd) {
  Campaign c = make_campaign(40, straight);
  Rng rng(40, "sine");
  Record& r = c.records[3];
  auto &F = r.trace.find("F_ref")->value, &U = r.trace.find("U")->value;
  for (std::size_t i = 0; i < F.size(); ++i) {
    F[i] = 2.2 + 1.8 * std::sin(6.0 * 3.14159265358979 * r.trace.time_bases[0].t_s[i]);
    U[i] = std::round((2.0 * F[i] + 0.2 + 0.004 * rng.normal()) * 409.6) / 409.6;
  }
  std::size_t held = 0;
  for (std::size_t j = 0; j < 18; ++j) {
    const std::size_t from = 1007 + 1119 * j, length = 20 + 2 * j;
    for (std::size_t i = 1; i < length; ++i) U[from + i] = U[from];
    held += length;
  }
  EXPECT_GT(check_raw_health(r, health_scales(c), c.bench).held, held * 9 / 10);
}

TEST(LostSamples, AnOutputThatGoesMissingAgainAndAgainLosesSamples) {
  const auto missing = [](std::size_t records, std::size_t each, std::size_t length, bool reference_too) {
    Campaign c = make_campaign(36, straight);
    for (std::size_t k = 0; k < records; ++k)
      for (std::size_t j = 0; j < each; ++j)
        for (std::size_t i = 0; i < length; ++i)
          for (const char* name : {"U", "F_ref"})
            if (reference_too || name[0] == 'U') c.records[k].trace.find(name)->value[1500 + 3001 * j + i] = kMissing;
    return claims_of_samples(c);
  };
  const std::vector<HealthClaim> claims = missing(8, 6, 80, false);
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "dropouts");
  EXPECT_NEAR(claims[0].value, 0.02, 1e-3);
  EXPECT_TRUE(missing(8, 6, 20, false).empty()) << "half a percent is noted, no finding";
  EXPECT_TRUE(missing(2, 7, 400, false).empty()) << "two records of eight";
  EXPECT_TRUE(missing(8, 6, 80, true).empty()) << "rows that were lost, not samples of the output";
}

TEST(LostSamples, ALoggerThatLosesCellsOfEveryColumnIsNoLossOfTheOutput) {
  // each cell of a column with its own chance
  const auto lost = [](double of_output, double of_reference) {
    Campaign c = make_campaign(38, straight);
    Rng rng(38, "cells");
    for (Record& r : c.records)
      for (const auto& [name, share] : {std::pair{"U", of_output}, std::pair{"F_ref", of_reference}})
        for (double& v : r.trace.find(name)->value)
          if (rng.uniform() < share) v = kMissing;
    return claims_of_samples(c);
  };
  EXPECT_TRUE(lost(0.017, 0.017).empty());
  EXPECT_TRUE(lost(0.06, 0.06).empty());
  const std::vector<HealthClaim> more = lost(0.05, 0.01);
  ASSERT_EQ(more.size(), 1u);
  EXPECT_EQ(more[0].effect, "dropouts");
  EXPECT_NEAR(more[0].value, 0.04, 2e-3) << more[0].evidence;
}

TEST(LostSamples, AFewZerosInSeveralRecordsAreDropouts) {
  const auto lost = [](std::size_t each) {
    Campaign c = make_campaign(24, straight);
    for (const std::size_t k : {0u, 3u})
      for (std::size_t j = 0; j < each; ++j) c.records[k].trace.find("U")->value[2100 + 3001 * j] = 0.0;
    return answer(std::move(c));
  };
  const Diagnosis few = lost(3);
  ASSERT_FALSE(few.findings.empty());
  EXPECT_EQ(few.findings.front().effect, "dropouts");
  EXPECT_GE(few.findings.front().probability, 0.5);
  const Diagnosis two = lost(1);
  for (const Finding& f : two.findings) EXPECT_LT(f.probability, 0.5) << f.effect;
}

TEST(LostSamples, TwoLossesOfSeveralSamplesAreDropoutsAndOneIsNoted) {
  const auto lost = [](std::size_t records) {
    Campaign c = make_campaign(41, straight);
    for (std::size_t k = 0; k < records; ++k) {
      auto& U = c.records[2 * k].trace.find("U")->value;
      const auto& F = c.records[2 * k].trace.find("F_ref")->value;
      const auto high = static_cast<std::size_t>(std::find_if(F.begin() + 1000, F.end(), [](double f) { return f > 1.5; }) - F.begin());
      for (std::size_t i = high; i < high + 6; ++i) U[i] = 0.0;
    }
    return c;
  };
  const std::vector<HealthClaim> claims = claims_of_samples(lost(2));
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "dropouts");
  const Diagnosis d = answer(lost(1));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_TRUE(std::ranges::any_of(d.notes, [](const std::string& n) { return n.find("6 at the low end") != std::string::npos; })) << told(d);
}

TEST(LostSamples, OneLongLossWhileTheForceHardlyMovesIsADropout) {
  Campaign c = make_campaign(32, straight);
  auto& U = c.records[2].trace.find("U")->value;
  for (std::size_t i = 6000; i < 6200; ++i) U[i] = 0.0;
  const std::vector<HealthClaim> lost = claims_of_samples(c);
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0].effect, "dropouts");
}

// What the output shows without the sensor is not always zero, and a contact is lost for three samples as well.
TEST(LostSamples, AFewFallsToTheLevelWithoutSensorAreLostSamples) {
  const auto fallen = [](std::size_t falls, double to_V) {
    Campaign c = make_campaign(41, straight);
    for (std::size_t k = 3; k < 5; ++k) {
      auto& U = c.records[k].trace.find("U")->value;
      const double lowest = *std::ranges::min_element(U);
      for (std::size_t j = 0, i = 500; j < falls; i += 997)
        if (U[i - 1] > lowest + 0.5 && U[i + 3] > lowest + 0.5) {
          for (std::size_t n = 0; n < 3; ++n) U[i + n] = lowest + to_V;
          ++j;
        }
    }
    return claims_of_samples(c);
  };
  const std::vector<HealthClaim> claims = fallen(2, -0.2);
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "dropouts");
  double samples = 0.0;
  for (const Record& r : make_campaign(41, straight).records) samples += static_cast<double>(r.trace.size());
  EXPECT_NEAR(claims[0].value * samples, 12.0, 1e-6);
  EXPECT_TRUE(fallen(2, 0.1).empty()) << "a level that the sensor has too";
}

// Twenty samples a second: a loss of some samples lasts while the force goes on.
Campaign slowly_sampled(std::uint64_t seed) {
  Campaign c = make_campaign(seed, straight);
  const auto thin = [](std::vector<double>& x) {
    for (std::size_t i = 0; 10 * i < x.size(); ++i) x[i] = x[10 * i];
    x.resize(x.size() / 10);
  };
  for (Record& r : c.records) {
    thin(r.trace.time_bases[0].t_s);
    for (Channel& channel : r.trace.channels) thin(channel.value);
  }
  return c;
}

TEST(LostSamples, TwoHoldsThroughATenthOfTheRangeAreDropouts) {
  const auto held = [](std::size_t records, std::size_t length) {
    Campaign c = slowly_sampled(42);
    for (std::size_t k = 0; k < records; ++k) {
      auto& U = c.records[3 + 4 * k].trace.find("U")->value;
      for (std::size_t i = 1; i < length; ++i) U[610 + i] = U[610];
    }
    return claims_of_samples(c);
  };
  const std::vector<HealthClaim> claims = held(2, 8);
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "dropouts");
  EXPECT_TRUE(held(1, 8).empty()) << "once, somebody's hand";
  EXPECT_TRUE(held(2, 5).empty()) << "through less";
}

TEST(LostSamples, AFallToTheFloorIsOneWhereTheOutputStaysAboveItAtLessForce) {
  const auto fallen = [](double above_N) {
    Campaign c = slowly_sampled(43);
    for (const std::size_t k : {3u, 7u}) {
      auto& U = c.records[k].trace.find("U")->value;
      const auto& F = c.records[k].trace.find("F_ref")->value;
      std::size_t i = 610;
      while (!(F[i] > above_N && F[i - 1] <= above_N)) ++i;
      for (std::size_t n = 0; n < 5; ++n) U[i + n] = 0.5;
    }
    return claims_of_samples(c);
  };
  const std::vector<HealthClaim> claims = fallen(0.9);
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].effect, "dropouts");
}

// Of a sensor whose output falls with force, as a resistance does, too: the force goes up by 3 N and comes back by one.
TEST(LostSamples, AHoldOverATurnIsSeenWhicheverWayTheOutputGoes) {
  for (const double gain_V_per_N : {2.0, -2.0}) {
    Campaign c = make_campaign(43, [&](const std::vector<double>& t, const std::vector<double>& F, int record) {
      std::vector<double> U = straight(t, F, record);
      for (double& u : U) u = gain_V_per_N > 0.0 ? u : 12.0 - u;
      return U;
    });
    Record& r = c.records[3];
    auto &F = r.trace.find("F_ref")->value, &U = r.trace.find("U")->value;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double x = std::fmod(0.005 * static_cast<double>(i), 4.0);
      F[i] = x < 2.0 ? 1.0 + 1.5 * x : 7.0 - 1.5 * x;
      U[i] = gain_V_per_N > 0.0 ? 0.2 + 2.0 * F[i] : 12.0 - 0.2 - 2.0 * F[i];
    }
    const std::size_t from = 2440, length = 210;  // past the top by less than it went up
    for (std::size_t i = 1; i < length; ++i) U[from + i] = U[from];
    EXPECT_GT(check_raw_health(r, health_scales(c), c.bench).held, length * 9 / 10) << gain_V_per_N;
  }
}

// What is lost is counted once, also where it is single samples.
TEST(LostSamples, SinglesThatFallToOneLevelAreCountedOnce) {
  Campaign c = make_campaign(44, straight);
  auto& U = c.records[3].trace.find("U")->value;
  const double lowest = *std::ranges::min_element(U) - 0.3;
  std::size_t lost = 0;
  for (std::size_t i = 701; i + 500 < U.size() && lost < 9; i += 1499, ++lost) U[i] = lowest;
  const RecordHealth health = check_raw_health(c.records[3], health_scales(c), c.bench);
  EXPECT_EQ(health.zeros + health.lone_zeros, lost);
  EXPECT_EQ(health.zero_runs, lost);
}

}  // namespace
}  // namespace forcegate::diagnose
