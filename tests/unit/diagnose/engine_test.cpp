#include "hil/diagnose/engine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hil/base/rng.h"

namespace forcegate::diagnose {
namespace {

// Forces of eight records; the output is made by the caller, noise and steps are those of ordinary instruments.
using Sensor = std::function<std::vector<double>(const std::vector<double>& t, const std::vector<double>& F,
                                                 int record)>;

Campaign make_campaign(std::uint64_t seed, const Sensor& sensor, double noise_V = 0.004) {
  Campaign c;
  c.name = "made";
  c.bench.reference_resolution_N = 0.025;
  c.bench.voltage_min_V = 0.0;
  c.bench.voltage_max_V = 10.0;
  Rng rng(seed, "campaign");
  const auto triangle = [](double t, double period) {
    const double x = std::fmod(t / period, 1.0);
    return x < 0.5 ? 2.0 * x : 2.0 - 2.0 * x;
  };
  for (int k = 0; k < 8; ++k) {
    Record r;
    r.name = "r" + std::to_string(k);
    r.kind = k % 4 == 1 ? "staircase" : k % 4 == 2 ? "hold" : "ramp";
    r.start_s = 900.0 * k;
    r.dynamic = false;
    r.role = k == 3 || k == 6 ? RecordRole::heldout : RecordRole::fit;
    TimeBase clock;
    std::vector<double> F;
    for (int i = 0; i < 24000; ++i) {
      const double t = i / 200.0;
      clock.t_s.push_back(t);
      double f = 0.0;
      if (k % 4 == 0) f = 0.2 + 4.2 * triangle(t, 60.0);
      if (k % 4 == 1) f = 0.5 + 0.7 * std::min(std::floor(t / 12.0), std::floor((120.0 - t) / 12.0));
      if (k % 4 == 2) f = t < 10.0 ? 0.3 : t < 70.0 ? 3.6 : 1.2;
      if (k % 4 == 3) f = 0.4 + 3.6 * triangle(t, 5.0);
      F.push_back(f);
    }
    const double gain = 1.0 + 0.005 * rng.normal(), offset = 0.01 * rng.normal();
    std::vector<double> U = sensor(clock.t_s, F, k);
    for (double& u : U)
      u = std::clamp(std::round((u * gain + offset + noise_V * rng.normal()) / 10.0 * 4096.0) / 4096.0 * 10.0,
                     0.0, 10.0);
    for (double& f : F) f = std::round((f + 0.006 * rng.normal()) / 0.025) * 0.025;
    r.trace.time_bases.push_back(clock);
    r.trace.channels.push_back({"F_ref", "N", "force", 0, F, {}});
    r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
    c.records.push_back(std::move(r));
  }
  return c;
}

std::vector<double> straight(const std::vector<double>&, const std::vector<double>& F, int) {
  std::vector<double> U;
  for (double f : F) U.push_back(2.0 * f + 0.2);
  return U;
}

Diagnosis answer(Campaign campaign, unsigned threads = 1) {
  EngineOptions options;
  options.threads = threads;
  auto out = diagnose_campaign(std::move(campaign), options);
  EXPECT_TRUE(out.has_value()) << (out ? "" : out.error().to_text());
  return out ? *out : Diagnosis{};
}

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
  EXPECT_EQ(d.findings.front().effect, "hysteresis");
  EXPECT_EQ(d.findings.front().side, "sensor");
  EXPECT_LT(d.error_after, d.error_before);
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
    if (is_timing(f.effect)) sum += f.probability;
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
    censored += static_cast<std::size_t>(std::count(h.bad.begin(), h.bad.end(), 1));
  }
  EXPECT_GT(censored, 1000u);
  for (std::uint64_t seed = 22; seed <= 24; ++seed) {
    const Diagnosis d = answer(make_campaign(seed, wider_than_the_range));
    EXPECT_EQ(d.verdict, DiagnosisVerdict::none)
        << seed << ": " << (d.findings.empty() ? "" : d.findings.front().effect);
  }
}

TEST(RawHealth, AFallToZeroThatTheForceDoesNotExplainIsLostSamples) {
  Campaign c = make_campaign(23, wider_than_the_range);
  auto& U = c.records[3].trace.find("U")->value;
  for (std::size_t i = 400; i + 20 < U.size(); i += 500)
    for (std::size_t k = 0; k < 12; ++k) U[i + k] = 0.0;
  EXPECT_GT(check_raw_health(c.records[3], health_scales(c), c.bench).zeros, 100u);
}

}  // namespace
}  // namespace forcegate::diagnose
