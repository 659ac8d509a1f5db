#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/base/rng.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

TEST(Engine, ClaimsNothingWhereNothingIsMissing) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Diagnosis d = answer(make_campaign(seed, straight));
    EXPECT_EQ(d.verdict, DiagnosisVerdict::none)
        << seed << ": " << (d.findings.empty() ? "" : d.findings.front().effect);
  }
}

TEST(Engine, NamesALoopMadeByRelays) {
  const Diagnosis d =
      answer(make_campaign(11, [](const std::vector<double>&, const std::vector<double>& F, int) {
        std::vector<double> U(F.size(), 0.0);
        int relays = 0;
        for (double alpha = 0.4; alpha < 4.6; alpha += 0.3)
          for (double beta = 0.2; beta < alpha; beta += 0.3) {
            ++relays;
            bool up = F[0] >= alpha;
            for (std::size_t i = 0; i < F.size(); ++i) {
              if (F[i] >= alpha) up = true;
              if (F[i] <= beta) up = false;
              U[i] += up ? 1.0 : 0.0;
            }
          }
        for (std::size_t i = 0; i < F.size(); ++i) U[i] = 1.85 * F[i] + 0.2 + 0.6 * U[i] / relays;
        return U;
      }));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::known);
  ASSERT_FALSE(d.findings.empty());
  const Finding& loop = d.findings.front();
  EXPECT_EQ(loop.effect, "hysteresis");
  EXPECT_EQ(loop.side, "sensor");
  EXPECT_LT(d.error_after, d.error_before);
  EXPECT_LE(loop.effect_rms, loop.error_before) << "a finding accounts for what the error falls by";
  // relays of every place and width up to the span, 0.6 V together at 2 V/N: half of them hold the middle up on the way down
  ASSERT_EQ(loop.parameters.size(), 2u);
  EXPECT_EQ(loop.parameters.front().name, "loop_width_N");
  EXPECT_NEAR(loop.parameters.front().value, 0.15, 0.05);
  EXPECT_GT(loop.parameters.front().u, 0.0);
}

TEST(Engine, NamesABentCurveMadeByASaturation) {
  const Diagnosis d =
      answer(make_campaign(12, [](const std::vector<double>&, const std::vector<double>& F, int) {
        std::vector<double> U;
        for (double f : F) U.push_back(9.0 * std::tanh(f / 5.0) + 0.2);
        return U;
      }));
  ASSERT_FALSE(d.findings.empty());
  EXPECT_EQ(d.findings.front().effect, "static_nonlinearity");
}

TEST(Engine, NamesCreepMadeByAPowerOfTime) {
  const Diagnosis d =
      answer(make_campaign(13, [](const std::vector<double>& t, const std::vector<double>& F, int) {
        std::vector<double> U(F.size(), 0.0);
        constexpr std::size_t kStride = 100;
        std::vector<double> step;
        for (std::size_t k = 0; k < F.size(); k += kStride)
          step.push_back(F[k] - (k >= kStride ? F[k - kStride] : 0.0));
        std::vector<double> coarse(step.size(), 0.0);
        for (std::size_t i = 0; i < step.size(); ++i)
          for (std::size_t k = 0; k <= i; ++k)
            coarse[i] += step[k] * (std::pow(1.0 + (t[i * kStride] - t[k * kStride]) / 2.0, 0.12) - 1.0);
        for (std::size_t i = 0; i < F.size(); ++i) {
          const std::size_t k = i / kStride, n = std::min(k + 1, coarse.size() - 1);
          const double share = static_cast<double>(i % kStride) / kStride;
          U[i] = 2.0 * F[i] + 0.2 + 0.25 * (coarse[k] + share * (coarse[n] - coarse[k]));
        }
        return U;
      }));
  ASSERT_FALSE(d.findings.empty());
  EXPECT_EQ(d.findings.front().effect, "creep");
  // 0.125 ((1 + t/2)^0.12 - 1) of the load: from 1 s to 100 s
  const FoundParameter& growth = d.findings.front().parameters.front();
  EXPECT_EQ(growth.name, "growth_per_decade");
  EXPECT_NEAR(growth.value, 0.125 * (std::pow(51.0, 0.12) - std::pow(1.5, 0.12)) / 2.0, 0.008);
}

TEST(Engine, NamesNothingThatLeavesMostOfAnErrorFarAboveTheNoise) {
  // the output also remembers the force of two seconds ago, and multiplies by it
  const Diagnosis d =
      answer(make_campaign(16, [](const std::vector<double>&, const std::vector<double>& F, int) {
        std::vector<double> U;
        for (std::size_t i = 0; i < F.size(); ++i) {
          const double old = F[i < 400 ? 0 : i - 400];
          U.push_back(2.0 * F[i] + 0.2 + 0.08 * (old - 2.0) * (F[i] - 2.0) * (old > 2.0 ? 1.0 : -0.6));
        }
        return U;
      }));
  for (const Finding& f : d.findings) EXPECT_LT(f.probability, 0.5) << f.effect;
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown);
}

TEST(Engine, AnAmplifierThatChangesItsRangeIsNoCurve) {
  // 4 % more above 3 N, until it falls below 1.5 N: a curve takes half of it
  const Diagnosis d = answer(make_campaign(17, [](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    bool high = false;
    for (const double f : F) {
      high = f > 3.0 || (high && f > 1.5);
      U.push_back(2.0 * f * (high ? 1.04 : 1.0) + 0.2);
    }
    return U;
  }));
  for (const Finding& f : d.findings) EXPECT_LT(f.probability, 0.5) << told(d);
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown);
}

TEST(Engine, StepsOfTheReferenceInAHandfulOfLevelsAreNoCurve) {
  for (std::uint64_t seed = 31; seed <= 33; ++seed) {
    Campaign c = make_campaign(seed, straight, 0.002);
    Rng rng(seed, "place");
    for (Record& r : c.records) {
      const double place = rng.uniform(0.0, 0.05);
      for (double& f : r.trace.channels[0].value) f = std::round((f + place) / 0.05) * 0.05;
    }
    c.bench.reference_resolution_N = 0.05;
    const Diagnosis d = answer(c);
    EXPECT_EQ(d.verdict, DiagnosisVerdict::none)
        << seed << ": " << (d.findings.empty() ? "" : d.findings.front().effect);
  }
}

TEST(Engine, CallsWhatIsOutsideTheLibraryUnknown) {
  const Diagnosis d = answer(make_campaign(14, [](const std::vector<double>& t, const std::vector<double>& F,
                                                  int record) {
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i)
      U.push_back(2.0 * F[i] + 0.2 + 0.2 * (std::sin(t[i] * t[i] / (40.0 + 7.0 * record)) > 0.3 ? 1.0 : 0.0));
    return U;
  }));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << (d.findings.empty() ? "" : d.findings.front().effect);
  EXPECT_FALSE(d.depends_on.empty());
}

TEST(Engine, TwoRecordsFarAboveTheirNoiseAreNotNothingAndAreNamed) {
  const auto bench = [](double lost_V) {
    return make_campaign(41, [lost_V](const std::vector<double>& t, const std::vector<double>& F, int record) {
      std::vector<double> U;
      for (std::size_t i = 0; i < F.size(); ++i)
        U.push_back(2.0 * F[i] + 0.2 - (record % 4 == 1 && std::fmod(t[i] * (1.0 + 0.13 * record), 7.0) < 1.0 ? lost_V : 0.0));
      return U;
    });
  };
  EXPECT_EQ(answer(bench(0.0)).verdict, DiagnosisVerdict::none);
  const Diagnosis d = answer(bench(0.13));
  for (const Finding& f : d.findings) EXPECT_LT(f.probability, 0.5) << f.effect;
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
  EXPECT_NE(told(d).find("far above what their instruments may leave: r"), std::string::npos) << told(d);
}

TEST(Engine, NamesAndFitsAnEquationOfTheUsersOwn) {
  const auto rippled = [](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    for (double f : F) U.push_back(2.0 * f + 0.2 + 0.12 * std::sin(3.1 * f));
    return U;
  };
  UserEffect mine;
  mine.name = "ripple";
  mine.output = "k * sin(w * F)";
  mine.parameters = {{"k", "N", 0.02, 0.0, -1.0, 1.0, 0.0}, {"w", "1/N", 2.9, 0.0, 1.0, 20.0, 0.0}};
  EngineOptions options;
  options.threads = 1;
  options.user_effects = {mine};
  const auto d = diagnose_campaign(make_campaign(16, rippled), options);
  ASSERT_TRUE(d.has_value());
  const auto found = std::find_if(d->findings.begin(), d->findings.end(),
                                  [](const Finding& f) { return f.effect == "ripple"; });
  ASSERT_NE(found, d->findings.end());
  EXPECT_GE(found->probability, 0.5);
  for (const FoundParameter& p : found->parameters)
    if (p.name == "w") {
      EXPECT_NEAR(p.value, 3.1, 0.1);
    }
}

TEST(Engine, RefusesAnEquationThatCannotBeRead) {
  UserEffect mine;
  mine.name = "broken";
  mine.output = "k * (F";
  mine.parameters = {{"k", "1", 0.02, 0.0, -1.0, 1.0, 0.0}};
  EngineOptions options;
  options.user_effects = {mine};
  const auto d = diagnose_campaign(make_campaign(17, straight), options);
  ASSERT_FALSE(d.has_value());
  EXPECT_NE(d.error().to_text().find("broken"), std::string::npos);
}

TEST(Engine, ASensorOfAnotherRangeWithTheSameDecayIsNoFinding) {
  // 0 to 200 N: the law's constants are those of a sensor of 5 N; nobody says which records are cyclic
  Campaign c = make_campaign(31, straight);
  c.bench.reference_resolution_N = kMissing;
  Rng rng(31, "range");
  for (std::size_t k = 0; k < c.records.size(); ++k) {
    Record& r = c.records[k];
    r.kind.clear();
    r.dynamic.reset();
    auto& F = r.trace.find("F_ref")->value;
    auto& U = r.trace.find("U")->value;
    const auto& t = r.trace.time_bases[0].t_s;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double low = 0.4,
                   force =
                       k % 4 == 3
                           ? low + 1.8 * (1.0 - std::cos(1.4 * t[i] * (1.0 + 0.2 * static_cast<double>(k))))
                           : F[i];
      const double D = k % 4 == 3 ? (std::exp(-0.02 * t[i]) + 0.5) / 1.5 : 1.0;
      U[i] = 2.0 * (k % 4 == 3 ? low + D * (force - low) : force) + 0.2 + 0.004 * rng.normal();
      F[i] = 40.0 * (force + 0.002 * rng.normal());
    }
  }
  const Diagnosis d = answer(std::move(c));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << (d.findings.empty() ? "" : d.findings.front().effect);
  EXPECT_LT(d.error_before, 0.02);
}

TEST(Engine, TwoSlowCyclesThatNobodyDeclaredMayDecayAsTheLawSays) {
  Campaign c = make_campaign(36, straight);
  for (const std::size_t k : {3u, 7u}) {
    Record& r = c.records[k];
    r.kind.clear();
    r.dynamic.reset();
    auto& F = r.trace.find("F_ref")->value;
    auto& U = r.trace.find("U")->value;
    const auto& t = r.trace.time_bases[0].t_s;
    Rng rng(36 + k, "slow");
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double low = 0.6, f = 0.025, force = low + 1.7 * (1.0 - std::cos(2.0 * std::numbers::pi * f * t[i]));
      const double D = (std::exp(-(0.0019 * f + 0.0056) * t[i]) + 0.2) / 1.2;  // Lebosse 2011, eq. (5) and (6)
      F[i] = std::round((force + 0.006 * rng.normal()) / 0.025) * 0.025;
      U[i] = 2.0 * (low + D * (force - low)) + 0.2 + 0.004 * rng.normal();
    }
  }
  const Diagnosis d = answer(std::move(c));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  for (const RecordError& r : d.records) EXPECT_LT(r.before, 0.03) << r.record;
}

TEST(Engine, WhatOnlyHeldOutRecordsShowIsASuspicion) {
  // a growth under load in the two records that no strength may be fitted to
  const Diagnosis d = answer(make_campaign(37, [](const std::vector<double>& t, const std::vector<double>& F, int record) {
    std::vector<double> U;
    double grown = 0.0;
    for (std::size_t i = 0; i < F.size(); ++i) {
      grown += (F[i] - grown) * -std::expm1(-(i > 0 ? t[i] - t[i - 1] : 0.0) / 4.0);
      U.push_back(2.0 * F[i] + 0.2 + (record == 3 || record == 6 ? 0.03 * grown : 0.0));
    }
    return U;
  }));
  for (const Finding& f : d.findings) EXPECT_LT(f.probability, 0.5) << told(d);
}

TEST(Engine, EffectsOfTimeShareOneProbability) {
  const Diagnosis d =
      answer(make_campaign(32, [](const std::vector<double>& t, const std::vector<double>& F, int) {
        std::vector<double> U;
        double fast = F[0], slow = F[0];
        for (std::size_t i = 0; i < F.size(); ++i) {
          const double dt = i > 0 ? t[i] - t[i - 1] : 0.005;
          fast += (F[i] - fast) * -std::expm1(-dt / 0.02);
          slow += (F[i] - slow) * -std::expm1(-dt / 0.09);
          U.push_back(2.0 * (0.6 * fast + 0.4 * slow) + 0.2);
        }
        return U;
      }));
  ASSERT_FALSE(d.findings.empty());
  EXPECT_EQ(d.findings.front().effect, "lag");
  double sum = 0.0;
  for (const Finding& f : d.findings)
    if (EffectRegistry::instance().find(f.effect)->traits.timing) sum += f.probability;
  EXPECT_LE(sum, 1.0);
}

TEST(Engine, SaysFromWhichSizeOnAnEffectBetweenRecordsWouldShow) {
  const Diagnosis d = answer(make_campaign(5, straight));
  const auto wear = std::find_if(d.ranking.begin(), d.ranking.end(),
                                 [](const RankedEffect& r) { return r.effect == "wear"; });
  ASSERT_NE(wear, d.ranking.end());
  EXPECT_GT(wear->visible_from, 1e-4);
  EXPECT_LT(wear->visible_from, 0.1);
}

TEST(Engine, GivesTheSameBytesForAnyNumberOfThreads) {
  EXPECT_EQ(to_json(answer(make_campaign(5, straight), 1)), to_json(answer(make_campaign(5, straight), 4)));
}

TEST(Engine, DoesNotTakeTheDeclaredResolutionOfTheReferenceForAnEffect) {
  const Diagnosis d = answer(make_campaign(15, straight, 0.0005));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << (d.findings.empty() ? "" : d.findings.front().effect);
}

TEST(MixedModel, RecoversFixedPartAndSpreadOfRecords) {
  MixedProblem p;
  p.nz = 2;
  p.n_fixed = 2;
  p.components = {{"gain", 0.1, 0.01}, {"offset", 0.1, 0.01}};
  p.component_of_z = {0, 1};
  p.fixed_prior_sd = Eigen::Vector2d(100, 100);
  p.column_prior_sd.resize(0);
  Rng rng(3, "mixed");
  for (int k = 0; k < 60; ++k) {
    const double gain = 1.5 + 0.2 * rng.normal(), offset = 0.3 + 0.05 * rng.normal();
    Eigen::MatrixXd A(400, 3);
    for (int i = 0; i < 400; ++i) {
      const double x = rng.uniform();
      A.row(i) << x, 1.0, gain * x + offset + 0.01 * rng.normal();
    }
    p.records.push_back({"", (A.transpose() * A) / 400.0, 400.0, 1e-8, 1e-8, false});
  }
  const MixedFit fit = fit_mixed(p, {}, nullptr, 60);
  ASSERT_TRUE(fit.valid);
  EXPECT_NEAR(fit.coefficient[0], 1.5, 0.08);
  EXPECT_NEAR(fit.coefficient[1], 0.3, 0.02);
  EXPECT_NEAR(std::sqrt(fit.variance[0]), 0.2, 0.05);
  EXPECT_NEAR(std::sqrt(fit.variance[1]), 0.05, 0.015);
}

// A cable at the middle of a divider sees film and resistor side by side: its time constant falls to a third over the range, and not to nothing. Euler
// steps at a tenth of the sample.
TEST(Engine, ACableOnADividerIsRcAndNoLag) {
  const Diagnosis d = answer(make_campaign(31, [](const std::vector<double>& t, const std::vector<double>& F, int) {
    constexpr double kFull_N = 4.4, kResistor = 0.35, kTau_s = 0.06;  // at no load and all of the resistor
    std::vector<double> U;
    double y = F[0];
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double dt = i == 0 ? 0.0 : (t[i] - t[i - 1]) / 10.0;
      for (int step = 0; step < 10; ++step) y += dt * (F[i] - y) * (F[i] / kFull_N + kResistor) / (kTau_s * kResistor);
      U.push_back(2.0 * y + 0.2);
    }
    return U;
  }));
  ASSERT_FALSE(d.findings.empty());
  EXPECT_EQ(d.findings.front().effect, "rc") << told(d);
  EXPECT_GE(d.findings.front().probability, 0.5) << told(d);
  EXPECT_LT(probability(d, "lag"), 0.5) << told(d);
}

TEST(Engine, ARecordWithoutUsableRowsIsLeftOutWithANote) {
  Campaign c = make_campaign(93, straight, 0.002);
  for (double& u : c.records[2].trace.find("U")->value) u = std::nan("");
  const std::string name = c.records[2].name;
  const Diagnosis d = answer(std::move(c));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none);
  EXPECT_TRUE(std::any_of(d.notes.begin(), d.notes.end(), [&](const std::string& n) { return n.starts_with(name + ": left out"); }));
}

TEST(Engine, ARecordWhoseOutputStandsStillIsLeftOutForThatReason) {
  Campaign c = make_campaign(93, straight, 0.002);
  for (double& u : c.records[2].trace.find("U")->value) u = 0.0;
  const std::string name = c.records[2].name;
  const Diagnosis d = answer(std::move(c));
  EXPECT_TRUE(std::any_of(d.notes.begin(), d.notes.end(), [&](const std::string& n) { return n.starts_with(name + ": left out, its output stands at 0 V"); }));
}

}  // namespace
}  // namespace forcegate::diagnose
