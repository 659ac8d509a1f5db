// What a finding says in numbers: values near the truth, uncertainties as large as the numbers scatter from specimen to specimen of noise.

#include "hil/diagnose/answer/shape_covariance.h"

#include <numeric>

#include "hil/diagnose/refit/refit.h"
#include "hil/model/model.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// Half of the force passes a pole of 60 ms.
std::vector<double> half_late(const std::vector<double>& t, const std::vector<double>& F, int) {
  std::vector<double> U;
  double slow = F[0];
  for (std::size_t i = 0; i < F.size(); ++i) {
    slow += (F[i] - slow) * -std::expm1(-(i > 0 ? t[i] - t[i - 1] : 0.005) / 0.06);
    U.push_back(2.0 * (0.5 * F[i] + 0.5 * slow) + 0.2);
  }
  return U;
}

// Nothing below 0.35 N.
std::vector<double> closes_late(const std::vector<double>&, const std::vector<double>& F, int) {
  std::vector<double> U;
  for (const double f : F) U.push_back(2.0 * std::max(0.0, f - 0.35) + 0.2);
  return U;
}

Refit added(std::uint64_t seed, const Sensor& sensor, double noise_V, const std::string& effect) {
  EngineOptions options;
  options.threads = 1;
  auto made = refit_campaign(make_campaign(seed, sensor, noise_V), options, *library_model("flexiforce"), effect);
  EXPECT_TRUE(made.has_value()) << (made ? "" : made.error().to_text());
  return made ? std::move(*made) : Refit{};
}

TEST(FoundParameters, ALagIsWhatTheOutputIsBehindARamp) {
  const Diagnosis d = answer(make_campaign(81, half_late, 0.002));
  ASSERT_FALSE(d.findings.empty());
  ASSERT_EQ(d.findings.front().effect, "lag") << told(d);
  ASSERT_EQ(d.findings.front().parameters.size(), 1u);
  const FoundParameter& lag = d.findings.front().parameters.front();
  EXPECT_EQ(lag.name, "lag_s");
  EXPECT_NEAR(lag.value, 0.5 * 0.06, 4.0 * lag.u + 0.001);
  EXPECT_GT(lag.u, 0.0);
  EXPECT_LT(lag.u, 0.003) << "the mean lag is known, whatever the forms do not tell apart";
}

TEST(FoundParameters, AThresholdScattersAsItsUncertaintySays) {
  constexpr int kSeeds = 8;
  std::vector<double> value;
  double u = 0.0;
  for (int k = 0; k < kSeeds; ++k) {
    const Refit r = added(90 + static_cast<std::uint64_t>(k), closes_late, 0.004, "dead_zone");
    ASSERT_EQ(r.model.effects.size(), 1u);
    const ModelParameter& F0 = r.model.effects.front().shape.front();
    EXPECT_NEAR(F0.value, 0.35, 0.05) << r.model.effects.front().form;
    value.push_back(F0.value);
    u += F0.se / kSeeds;
  }
  const double mean = std::accumulate(value.begin(), value.end(), 0.0) / kSeeds;
  double square = 0.0;
  for (const double v : value) square += (v - mean) * (v - mean);
  const double scatter = std::sqrt(square / (kSeeds - 1));
  EXPECT_GT(u, 0.0);
  EXPECT_LT(scatter, 3.0 * u);
  EXPECT_GT(scatter, u / 6.0);
}

TEST(FoundParameters, LessNoiseKnowsAShapeBetter) {
  const auto u_at = [](double noise_V) { return added(99, closes_late, noise_V, "dead_zone").model.effects.front().shape.front().se; };
  EXPECT_LT(u_at(0.002), 0.6 * u_at(0.02));
}

TEST(FoundParameters, WhatTheRecordsDoNotTellIsAsWideAsItsBounds) {
  // a loop and a curve say nothing of the time constant of a lag that is not there
  const Refit r = added(101, [](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    for (const double f : F) U.push_back(2.0 * f + 0.2);
    return U;
  }, 0.004, "lag");
  ASSERT_FALSE(r.model.effects.empty());
  const ModelParameter& tau = r.model.effects.front().shape.front();
  EXPECT_GT(tau.se, tau.value) << "a strength of nothing has no time constant";
  EXPECT_LE(tau.se, 1.0001 * (tau.maximum - tau.minimum));
}

}  // namespace
}  // namespace forcegate::diagnose
