#include <algorithm>
#include <numbers>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

bool claims_any(const Diagnosis& d) {
  return std::any_of(d.findings.begin(), d.findings.end(), [](const Finding& f) { return f.probability >= 0.5; });
}

bool notes_say(const Diagnosis& d, const std::string& words) {
  return std::any_of(d.notes.begin(), d.notes.end(), [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

// A rubber under the film that is soft up to the largest force of its record: what loops is the first loading alone.
TEST(Outdone, SofteningByTheLargestForceIsNoHysteresis) {
  const Diagnosis d = answer(make_campaign(11, [](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    double largest = F[0];
    for (const double f : F) {
      largest = std::max(largest, f);
      U.push_back(2.0 * (f + 0.04 * (largest - f) * std::sqrt(f)) + 0.2);
    }
    return U;
  }));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
  EXPECT_FALSE(claims_any(d)) << told(d);
  ASSERT_FALSE(d.depends_on.empty());
  EXPECT_EQ(d.depends_on.front(), "history");
  EXPECT_EQ(d.follows, std::vector<std::string>{"the largest force so far"}) << told(d);
  EXPECT_TRUE(notes_say(d, "the output follows the largest force so far")) << told(d);
}

// Contacts that stay where they were pressed: every load up to the largest so far finds a larger gain.
TEST(Outdone, AGainThatTheLargestForceLeavesBehindIsNoLoop) {
  const Diagnosis d = answer(make_campaign(15, [](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    double largest = F[0];
    for (const double f : F) {
      largest = std::max(largest, f);
      U.push_back(1.6 * f * (1.0 + 0.3 * largest / (largest + 6.0)) + 0.2);
    }
    return U;
  }));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
  EXPECT_FALSE(claims_any(d)) << told(d);
  EXPECT_EQ(d.follows, std::vector<std::string>{"the largest force so far"}) << told(d);
}

// Heun steps at a twentieth of the sample, so that nothing is shared with the column that is fitted.
TEST(Outdone, AResonanceIsNoLag) {
  const Diagnosis d = answer(make_campaign(12, [](const std::vector<double>& t, const std::vector<double>& F, int) {
    constexpr double w = 2.0 * std::numbers::pi * 5.0, damping = 0.12;
    constexpr int kSteps = 20;
    std::vector<double> U;
    double y = F[0], v = 0.0;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double dt = i == 0 ? 0.0 : (t[i] - t[i - 1]) / kSteps, f = F[i];
      for (int s = 0; s < kSteps; ++s) {
        const double a = w * w * (f - y) - 2.0 * damping * w * v, y1 = y + dt * v, v1 = v + dt * a;
        const double a1 = w * w * (f - y1) - 2.0 * damping * w * v1;
        y += 0.5 * dt * (v + v1);
        v += 0.5 * dt * (a + a1);
      }
      U.push_back(2.0 * (f + 0.6 * (y - f)) + 0.2);
    }
    return U;
  }));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
  EXPECT_FALSE(claims_any(d)) << told(d);
  EXPECT_EQ(d.follows, std::vector<std::string>{"a resonance"}) << told(d);
  ASSERT_FALSE(d.depends_on.empty());
  EXPECT_EQ(d.depends_on.front(), "rate");
}

TEST(Outdone, AGainThatGrowsWithTheSizeOfTheRateIsNoCurve) {
  const Diagnosis d = answer(make_campaign(13, [](const std::vector<double>& t, const std::vector<double>& F, int) {
    std::vector<double> U;
    double size = 0.0;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double dt = i == 0 ? 1.0 : t[i] - t[i - 1], rate = i == 0 ? 0.0 : std::abs(F[i] - F[i - 1]) / dt;
      size += (rate - size) * -std::expm1(-dt / 0.1);
      U.push_back(2.0 * F[i] * (1.0 + 0.02 * size) + 0.2);
    }
    return U;
  }));
  EXPECT_FALSE(claims_any(d)) << told(d);
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
}

// The same comparison must leave a true name where it is: a lag is followed nearly as well by a stiff spring, a loop in part by the largest force.
TEST(Outdone, TrueNamesStay) {
  const auto lag = answer(make_campaign(14, [](const std::vector<double>& t, const std::vector<double>& F, int) {
    std::vector<double> U;
    double y = F[0];
    for (std::size_t i = 0; i < F.size(); ++i) {
      y += (F[i] - y) * -std::expm1(-(i == 0 ? 0.0 : t[i] - t[i - 1]) / 0.06);
      U.push_back(2.0 * y + 0.2);
    }
    return U;
  }));
  EXPECT_GE(probability(lag, "lag"), 0.5) << told(lag);
  EXPECT_FALSE(notes_say(lag, "no effect of the library")) << told(lag);

  const auto loop = answer(make_campaign(15, [](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    double narrow = F[0], wide = F[0];
    for (const double f : F) {
      narrow = std::clamp(narrow, f - 0.2, f + 0.2);
      wide = std::clamp(wide, f - 1.1, f + 1.1);
      U.push_back(2.0 * (f + 0.06 * narrow + 0.05 * wide) + 0.2);
    }
    return U;
  }));
  EXPECT_GE(probability(loop, "hysteresis"), 0.5) << told(loop);
  EXPECT_FALSE(notes_say(loop, "no effect of the library")) << told(loop);
}

}  // namespace
}  // namespace forcegate::diagnose
