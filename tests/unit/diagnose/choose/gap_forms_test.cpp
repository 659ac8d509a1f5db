// Dead zones of gaps that no form describes by its own equation, or at no point of its grid.

#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

// A gap that closes at once, of any width: between two widths that are tried first another form fits better than either.
TEST(HardGap, OfAnyWidthIsFound) {
  const auto triangle = [](double t, double period_s) {
    const double x = std::fmod(t / period_s, 1.0);
    return x < 0.5 ? 2.0 * x : 2.0 - 2.0 * x;
  };
  // ramps, a staircase, a hold, a sine: much of it in the gap
  const auto force = [&](double t) {
    if (t < 10.0) return 0.3;
    if (t < 170.0) return 0.3 + 3.7 * triangle(t - 10.0, 80.0);
    if (t < 345.0) return 4.0 - std::abs(std::floor((t - 170.0) / 25.0) - 3.0);
    if (t < 445.0) return 3.5;
    if (t < 505.0) return 0.5;
    return t < 565.0 ? 2.0 + 1.5 * std::sin(3.14159265358979 * (t - 505.0)) : 0.3;
  };
  for (const double gap_N : {0.5, 0.72, 0.8, 0.88}) {
    const Diagnosis d = answer(recording(50.0, 29000, force, [&](const std::vector<double>&, const std::vector<double>& F) {
      std::vector<double> U;
      for (const double f : F) U.push_back(-0.2 + 2.0 * std::max(0.0, f - gap_N));
      return U;
    }, 0.003));
    ASSERT_FALSE(d.findings.empty());
    EXPECT_EQ(d.findings.front().effect, "dead_zone") << told(d);
    for (const FoundParameter& p : d.findings.front().parameters)
      if (p.name == "F0_N") {
        EXPECT_NEAR(p.value, gap_N, 0.02) << told(d);
      }
    EXPECT_LT(d.error_after, 1.5 * d.floor) << gap_N;
  }
}

// A few contacts close late: of those that are open at F0 a share of (1 + F/F0)^-2 is open at F.
TEST(LongTailedGap, IsNoCurveForCertain) {
  for (const double F0_N : {0.3, 0.6}) {
    const Diagnosis d = answer(make_campaign(83, [=](const std::vector<double>&, const std::vector<double>& F, int) {
      std::vector<double> U;
      for (const double f : F) U.push_back(0.2 + 2.0 * f * f / (f + F0_N));
      return U;
    }));
    EXPECT_GT(probability(d, "dead_zone"), 0.4) << told(d);
    EXPECT_LT(probability(d, "static_nonlinearity"), 0.6) << told(d);
    EXPECT_LT(d.error_after, 2.0 * d.floor) << told(d);
  }
}

}  // namespace
}  // namespace forcegate::diagnose
