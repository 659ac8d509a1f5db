#include "hil/model/rows.h"
#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

constexpr double kOnset_s = 150.0;

// A ramp, a rest, and then a load of many heights.
double load(double t) {
  if (t < 100.0) return 0.5 + 3.5 * (t < 50.0 ? t / 50.0 : 2.0 - t / 50.0);
  if (t < kOnset_s) return 0.5;
  const double s = t - kOnset_s;
  return 0.5 + 1.1 * (2.0 - std::cos(2.0 * M_PI * 0.31 * s) - std::cos(2.0 * M_PI * 0.47 * s)) * (1.0 + 0.4 * std::sin(0.13 * s));
}

Campaign film(double loss) {
  return recording(
      50.0, 22500, load,
      [loss](const std::vector<double>& t, const std::vector<double>& F) {
        std::vector<double> U;
        for (std::size_t i = 0; i < t.size(); ++i)
          U.push_back(0.3 + 2.0 * (0.5 + (1.0 - loss * -std::expm1(-0.008 * std::max(0.0, t[i] - kOnset_s))) * (F[i] - 0.5)));
        return U;
      },
      0.004);
}

TEST(LateCycles, CyclesOfManyHeightsBehindARampAndARestDecayFromWhereTheyBegin) {
  const Diagnosis d = answer(film(0.7));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_LT(d.error_before, 0.02) << told(d);
}

TEST(LateCycles, AFilmThatLosesNothingIsStatic) {
  const Diagnosis d = answer(film(0.0));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_LT(d.error_before, 0.01);
}

TEST(LateCycles, TheyMayBeginBehindTheLongestStretchesWithoutATurn) {
  auto input = make_campaign_input(film(0.7));
  ASSERT_TRUE(input.has_value());
  const std::vector<double> begin_s = cycles_may_begin_s(input->records.front(), input->range_N);
  EXPECT_TRUE(std::ranges::any_of(begin_s, [](double s) { return std::abs(s - kOnset_s) < 4.0; })) << begin_s.size();
}

}  // namespace
}  // namespace forcegate::diagnose
