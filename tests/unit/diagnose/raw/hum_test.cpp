// Hum beside something else: what a record of few samples a second shows once the line is taken off, and what it is left with where its rate
// folds the line onto the slow.

#include <numbers>

#include "hil/diagnose/raw/mains_line.h"
#include "hil/diagnose/raw/mains_removal.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// Larger where the film conducts less, with a third harmonic, and a phase that wanders.
double hum_V(double t_s, double F_N) {
  const double phase = kTurn * 50.02 * t_s + 0.4 * std::sin(kTurn * t_s / 60.0);
  return 0.2 * (0.4 + std::exp(-F_N / 2.0)) * (std::sin(phase) + 0.3 * std::sin(3.0 * phase + 1.0));
}

double rms(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double v : x) sum += v * v;
  return std::sqrt(sum / static_cast<double>(x.size()));
}

TEST(Hum, IsTakenOffWhateverTheClockAndTheLoadDo) {
  constexpr double kRate_Hz = 80.0, kNoise_V = 0.002;
  for (const double digit_s : {1e-6, 1e-3}) {
    Rng rng(7, "hum");
    std::vector<double> t_s, F_N, U_V, clean_V;
    double taken_V2 = 0.0;
    for (int i = 0; i < 8000; ++i) {
      const double t = i / kRate_Hz + (i > 3000 && digit_s < 1e-4 ? 1.7 : 0.0);  // a gap
      t_s.push_back(digit_s * std::round(t / digit_s));
      F_N.push_back(2.0 + 1.8 * std::sin(kTurn * 0.3 * t));
      clean_V.push_back(0.3 + 2.0 * F_N.back() + 0.05 * std::sin(kTurn * 0.05 * t) + kNoise_V * rng.normal());
      U_V.push_back(clean_V.back() + hum_V(t, F_N.back()));
      taken_V2 += std::pow(hum_V(t, F_N.back()), 2) / 8000.0;
    }
    U_V[4000] = kMissing;
    const std::vector<std::uint8_t> bad(U_V.size(), 0);
    const double mean_square = remove_mains_line(t_s, F_N, bad, 50.0, kRate_Hz, U_V);
    EXPECT_NEAR(mean_square, taken_V2, 0.03 * taken_V2);
    std::vector<double> left;
    for (std::size_t i = 0; i < U_V.size(); ++i)
      if (std::isfinite(U_V[i])) left.push_back(U_V[i] - clean_V[i]);
    EXPECT_EQ(left.size(), U_V.size() - 1);
    EXPECT_LT(rms(left), 0.15 * std::sqrt(taken_V2)) << digit_s;
  }
}

TEST(Hum, OnAForceThatStandsStillLeavesTheLevelAlone) {
  std::vector<double> t_s, F_N(4000, 1.5), U_V;
  for (int i = 0; i < 4000; ++i) {
    t_s.push_back(i / 80.0);
    U_V.push_back(3.3 + 0.1 * std::sin(kTurn * 60.0 * t_s.back()));
  }
  const std::vector<std::uint8_t> bad(U_V.size(), 0);
  EXPECT_NEAR(remove_mains_line(t_s, F_N, bad, 60.0, 80.0, U_V), 0.005, 1e-4);
  for (const double u : U_V) EXPECT_NEAR(u, 3.3, 1e-3);
}

// A coarse reference scatters by more than the line: the output alone shows it. A force that vibrates with the mains is no hum.
TEST(Hum, IsSeenBesideACoarseReferenceAndToldFromAForceThatVibrates) {
  for (const bool vibrates : {false, true}) {
    Rng rng(3, "coarse");
    std::vector<double> t_s, F_N, U_V;
    for (int i = 0; i < 20000; ++i) {
      t_s.push_back(i / 200.0);
      const double line = 0.014 * std::sin(kTurn * 50.02 * t_s.back());
      const double F = 2.0 + 1.5 * std::sin(kTurn * 0.3 * t_s.back()) + (vibrates ? line / 2.0 : 0.0);
      F_N.push_back(0.025 * std::round((F + 0.006 * rng.normal()) / 0.025));
      U_V.push_back(0.3 + 2.0 * F + (vibrates ? 0.0 : line) + 0.002 * rng.normal());
    }
    const MainsLine line = find_mains_line(t_s, F_N, U_V, 2.0);
    if (vibrates) {
      EXPECT_LT(line.ratio, 5.0);
    } else {
      EXPECT_GT(line.ratio, 100.0);
      EXPECT_NEAR(line.amplitude_V, 0.014, 0.002);
    }
  }
}

// Half a period of the mains goes missing again and again: a count of samples would lose its phase there.
TEST(Hum, IsSeenAcrossShortGapsAndInShortRecords) {
  for (const double duration_s : {7.0, 12.0}) {
    std::vector<double> t_s, F_N, U_V;
    for (int i = 0; i < 1000 * static_cast<int>(duration_s); ++i) {
      if (i % 450 < 10) continue;
      t_s.push_back(i / 1000.0);
      F_N.push_back(2.0 + std::sin(kTurn * 0.3 * t_s.back()));
      U_V.push_back(0.3 + 2.0 * F_N.back() + 0.06 * std::sin(kTurn * 50.0 * t_s.back()));
    }
    const MainsLine line = find_mains_line(t_s, F_N, U_V, 2.0);
    EXPECT_NEAR(line.frequency_Hz, 50.0, 1e-6) << duration_s;
    EXPECT_NEAR(line.amplitude_V, 0.06, 0.006) << duration_s;
    EXPECT_GT(line.ratio, 100.0) << duration_s;
  }
}

// Stick-slip 16.6 times a second has its third harmonic beside the mains; what repeats 12.5 times has a fourth one right at them.
TEST(Hum, IsNoHarmonicOfALowerLine) {
  for (const double turns_Hz : {16.6, 16.667, 12.5, 25.0, 7.143}) {
    for (const double rate_Hz : {100.0, 1000.0}) {
      Rng rng(4, "saw");
      std::vector<double> t_s, F_N, U_V;
      for (int i = 0; i < static_cast<int>(120.0 * rate_Hz); ++i) {
        t_s.push_back(i / rate_Hz);
        F_N.push_back(2.0 + std::sin(kTurn * 0.2 * t_s.back()) + 0.01 * rng.normal());
        U_V.push_back(0.4 * F_N.back() + 0.02 * (std::fmod(turns_Hz * t_s.back() + 0.3, 1.0) - 0.5) + 0.002 * rng.normal());
      }
      EXPECT_LT(find_mains_line(t_s, F_N, U_V, 0.4).ratio, kPlainLine) << turns_Hz << " of " << rate_Hz;
    }
  }
}

TEST(Hum, IsAtTheFrequencyOfTheMainsAndToldAsMeasured) {
  for (const double line_Hz : {49.75, 49.96, 50.03, 50.3}) {
    Rng rng(5, "beside");
    std::vector<double> t_s, F_N, U_V;
    for (int i = 0; i < 40000; ++i) {
      t_s.push_back(i / 500.0);
      F_N.push_back(2.0 + std::sin(kTurn * 0.2 * t_s.back()));
      // a stronger line of a machine, whose fifth harmonic this would be if there were others
      U_V.push_back(0.4 * F_N.back() + 0.02 * std::sin(kTurn * line_Hz * t_s.back()) + 0.03 * std::sin(kTurn * 10.0 * t_s.back()) + 0.002 * rng.normal());
    }
    const MainsLine line = find_mains_line(t_s, F_N, U_V, 0.4);
    if (std::abs(line_Hz - 50.0) < 0.1) {
      EXPECT_GT(line.ratio, 100.0) << line_Hz;
      EXPECT_NEAR(line.frequency_Hz, line_Hz, 0.006);
    } else {
      EXPECT_LT(line.ratio, kPlainLine) << line_Hz;
    }
  }
}

// The made campaign at a slower clock, a loop of friction and hum on its output. Every `folded`-th record is sampled at just the mains.
Campaign slow_campaign(std::uint64_t seed, double loop_V, std::size_t folded) {
  Campaign c = make_campaign(seed, straight);
  for (std::size_t k = 0; k < c.records.size(); ++k) {
    const double rate_Hz = folded > 0 && k % folded == 0 ? 49.98 : 40.0;
    auto& clock = c.records[k].trace.time_bases[0].t_s;
    auto& F = c.records[k].trace.find("F_ref")->value;
    auto& U = c.records[k].trace.find("U")->value;
    double play = F[0];
    for (std::size_t i = 0; i < clock.size(); ++i) {
      clock[i] = static_cast<double>(i) / rate_Hz;
      play = std::clamp(play, F[i] - 0.3, F[i] + 0.3);
      U[i] += loop_V * (play - F[i]) / 0.3 + hum_V(clock[i], F[i]);
    }
  }
  return c;
}

// A supply behind a full-wave rectifier hums at twice the mains.
TEST(Hum, TheRippleOfARectifierIsHumAtEveryRateThatShowsIt) {
  for (const double rate_Hz : {125.0, 200.0, 500.0}) {
    Campaign c = make_campaign(67, straight);
    for (Record& r : c.records) {
      auto& clock = r.trace.time_bases[0].t_s;
      auto& F = r.trace.find("F_ref")->value;
      auto& U = r.trace.find("U")->value;
      for (std::size_t i = 0; i < clock.size(); ++i) {
        clock[i] = static_cast<double>(i) / rate_Hz;
        U[i] += rate_Hz == 200.0 ? 0.0 : 0.08 * std::sin(2.0 * kTurn * 49.98 * clock[i] + 0.3) * (0.5 + 0.1 * F[i]);
      }
    }
    const Diagnosis d = answer(std::move(c));
    if (rate_Hz == 200.0) {
      EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
      continue;
    }
    EXPECT_GE(probability(d, "hum"), 0.9) << rate_Hz << told(d);
    EXPECT_LT(d.error_after, 0.4 * d.error_before) << rate_Hz;
  }
}

TEST(Hum, DoesNotHideTheLoopBesideIt) {
  int both = 0;
  for (std::uint64_t seed = 61; seed <= 63; ++seed) {
    const Diagnosis d = answer(slow_campaign(seed, 0.03, 0));
    EXPECT_GE(probability(d, "hum"), 0.9) << told(d);
    EXPECT_FALSE(d.residual_unknown) << told(d);
    both += probability(d, "hysteresis") >= 0.5 ? 1 : 0;
    EXPECT_LT(d.error_after, 0.2 * d.error_before);
  }
  EXPECT_EQ(both, 3);
}

// Of records at 50 samples a second, a fast one tells what their slow waves are.
TEST(Hum, OneRecordIsEnoughWhereTheOthersFoldIt) {
  const Diagnosis d = answer(slow_campaign(66, 0.0, 1));
  EXPECT_LT(probability(d, "hum"), 0.5) << "none can show it";
  Campaign c = slow_campaign(66, 0.0, 1);
  auto& clock = c.records[1].trace.time_bases[0].t_s;
  auto& F = c.records[1].trace.find("F_ref")->value;
  auto& U = c.records[1].trace.find("U")->value;
  for (std::size_t i = 0; i < clock.size(); ++i) {
    U[i] -= hum_V(clock[i], F[i]);
    clock[i] = static_cast<double>(i) / 400.0;
    U[i] += hum_V(clock[i], F[i]);
  }
  const Diagnosis told_by_one = answer(c);
  EXPECT_GE(probability(told_by_one, "hum"), 0.9) << told(told_by_one);
  EXPECT_FALSE(told_by_one.residual_unknown) << told(told_by_one);
}

TEST(Hum, FoldedOntoTheSlowIsNoStructureToLearnFrom) {
  for (std::uint64_t seed = 64; seed <= 65; ++seed) {
    const Diagnosis d = answer(slow_campaign(seed, 0.0, 2));
    EXPECT_GE(probability(d, "hum"), 0.9) << told(d);
    EXPECT_EQ(d.findings.size(), 1u) << told(d);
    EXPECT_FALSE(d.residual_unknown) << told(d);
  }
}

// |sin| of a load of 1 Hz, sampled at 50 a second: its lines stand every 2 Hz, 20 Hz among them, onto which 120 Hz fold.
TEST(Hum, ALineOfTheLoadIsNone) {
  for (const double load_Hz : {0.5, 1.0, 2.0}) {
    Rng rng(6, "load");
    std::vector<double> t_s, F_N, U_V;
    for (int i = 0; i < 6000; ++i) {
      t_s.push_back(i / 50.0);
      F_N.push_back(2.0 + 1.5 * std::cos(kTurn * load_Hz * t_s.back()));
      U_V.push_back(0.4 * F_N.back() + 0.1 * std::abs(std::sin(kTurn * load_Hz * t_s.back())) + 1e-5 * rng.normal());
    }
    EXPECT_LT(find_mains_line(t_s, F_N, U_V, 0.4).ratio, kPlainLine) << load_Hz;
    for (std::size_t i = 0; i < U_V.size(); ++i) U_V[i] = 0.4 * F_N[i] + 0.01 * std::sin(kTurn * 120.0 * t_s[i]) + 0.002 * rng.normal();
    EXPECT_GT(find_mains_line(t_s, F_N, U_V, 0.4).ratio, kPlainLine) << "a whole multiple of the load as well, and alone there";
  }
}

// Five samples are two periods of 100 Hz: between two codes they come again and again, and no buffer was read twice.
TEST(Hum, ThatComesAgainAtEveryFifthSampleIsNoBlockSentAgain) {
  Campaign c = make_campaign(68, straight);
  for (Record& r : c.records) {
    auto& clock = r.trace.time_bases[0].t_s;
    auto& F = r.trace.find("F_ref")->value;
    auto& U = r.trace.find("U")->value;
    Rng rng(9, r.name);
    for (std::size_t i = 0; i < clock.size(); ++i) {
      clock[i] = static_cast<double>(i) / 250.0;
      const double force_N = 0.4 + 0.5 * std::floor(clock[i] / 12.0);
      F[i] = 0.025 * std::round((force_N + 0.006 * rng.normal()) / 0.025);
      U[i] = 0.02 * std::round((2.0 * force_N + 0.2 + 0.15 * std::sin(kTurn * 100.0 * clock[i]) + 0.008 * rng.normal()) / 0.02);
    }
  }
  for (const HealthClaim& claim : claims_of_samples(c)) EXPECT_EQ(claim.effect, "hum") << claim.evidence;
}

// The mains in one record and their rectifier in the other are one supply.
TEST(Hum, OfTheMainsInOneRecordAndOfTheirRectifierInTheOtherIsHum) {
  for (const double second_Hz : {100.0, 120.0}) {
    Campaign c = make_campaign(69, straight);
    c.records.resize(2);
    for (std::size_t k = 0; k < 2; ++k) {
      auto& clock = c.records[k].trace.time_bases[0].t_s;
      auto& U = c.records[k].trace.find("U")->value;
      for (std::size_t i = 0; i < clock.size(); ++i) {
        clock[i] = static_cast<double>(i) / 256.0;
        U[i] += 0.08 * std::sin(kTurn * (k == 0 ? 50.0 : second_Hz) * clock[i]);
      }
    }
    const std::vector<HealthClaim> claims = claims_of_samples(c);
    EXPECT_EQ(claims.size(), second_Hz == 100.0 ? 1U : 0U) << second_Hz;
    EXPECT_EQ(note_of_claims(claims), second_Hz == 100.0 ? "taken out of the samples before any fit, see diagnose: hum (" + claims.front().evidence + ")" : "");
  }
}

}  // namespace
}  // namespace forcegate::diagnose
