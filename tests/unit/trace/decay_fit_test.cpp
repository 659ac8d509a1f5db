#include "hil/trace/decay_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "hil/base/rng.h"

namespace forcegate {
namespace {

struct Maxima {
  std::vector<double> t, u;
};

Maxima decay(double a, double b, double level, double step_s, int n, double first_s = 1.0) {
  Maxima m;
  for (int i = 0; i < n; ++i) {
    m.t.push_back(first_s + step_s * i);
    m.u.push_back(level + a * std::exp(-b * m.t.back()));
  }
  return m;
}

TEST(FitDecay, ReturnsTheParametersOfAnExactDecay) {
  for (const double b : {4e-4, 0.0066, 0.0113, 0.05, 0.4})
    for (const double a : {0.7, -0.2}) {
      const auto m = decay(a, b, 1.5, 2.0, 600);
      const auto fit = fit_decay(m.t, m.u, 0.4);
      ASSERT_TRUE(fit) << fit.error().to_text();
      EXPECT_NEAR(fit->b_per_s, b, 1e-7 * b);
      EXPECT_NEAR(fit->a_V, a, 1e-7);
      EXPECT_NEAR(fit->c_V, 1.1, 1e-7);
      EXPECT_LT(fit->rmse_V, 1e-9);
      EXPECT_EQ(fit->n, 600);
    }
}

TEST(FitDecay, StatesAnUncertaintyThatHoldsTheTruth) {
  int inside = 0;
  const int runs = 200;
  for (int run = 0; run < runs; ++run) {
    Rng rng(static_cast<std::uint64_t>(run), "decay");
    auto m = decay(0.8, 0.0066, 1.2, 2.0, 600);
    double correlated = 0.0;
    for (double& u : m.u) u += correlated = 0.8 * correlated + rng.normal(0.0, 0.01);
    const auto fit = fit_decay(m.t, m.u, 0.0);
    ASSERT_TRUE(fit);
    inside += std::fabs(fit->b_per_s - 0.0066) < 2.0 * fit->u_b_per_s;
  }
  EXPECT_GT(inside, runs * 86 / 100);  // the ordinary formula alone covers about half of them
}

TEST(FitDecay, RefersTheAmplitudeToTimeZero) {
  const auto m = decay(0.8, 0.01, 1.2, 2.0, 300, 100.0);
  const auto fit = fit_decay(m.t, m.u, 0.0);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->a_V, 0.8, 1e-6);
}

TEST(FitDecay, RefusesWhatDoesNotDetermineADecay) {
  const auto few = decay(0.8, 0.01, 1.2, 60.0, 5);
  EXPECT_EQ(fit_decay(few.t, few.u, 0.0).error().code, ErrorCode::parse);
  const auto flat = decay(0.0, 0.01, 1.2, 2.0, 100);
  EXPECT_FALSE(fit_decay(flat.t, flat.u, 0.0));
  const auto brief = decay(0.8, 0.001, 1.2, 2.0, 20);
  EXPECT_FALSE(fit_decay(brief.t, brief.u, 0.0));
  auto holed = decay(0.8, 0.01, 1.2, 2.0, 100);
  holed.u[7] = std::nan("");
  EXPECT_NE(fit_decay(holed.t, holed.u, 0.0).error().text.find("number 8"), std::string::npos);
  auto instant = decay(0.8, 0.01, 1.2, 0.0, 100);
  instant.u[3] += 0.1;
  EXPECT_FALSE(fit_decay(instant.t, instant.u, 0.0));
}

TEST(FitDecay, NeverGivesAnythingButNumbersForNoise) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Rng rng(seed, "noise");
    Maxima m;
    const auto n = 6 + static_cast<int>(rng.below(60));
    for (int i = 0; i < n; ++i) {
      m.t.push_back(rng.uniform(0, 500));
      m.u.push_back(rng.normal());
    }
    const auto fit = fit_decay(m.t, m.u, 0.0);
    if (!fit) continue;
    EXPECT_TRUE(std::isfinite(fit->a_V) && std::isfinite(fit->b_per_s) && std::isfinite(fit->c_V));
    EXPECT_GE(fit->u_b_per_s, 0.0);
  }
}

}  // namespace
}  // namespace forcegate
